"""Forces that come again over the position: a weight that turns, magnets, teeth."""

from dataclasses import replace
from typing import ClassVar

import numpy as np

from pipeline.physics.force_term import ForceTerm
from pipeline.physics.force_units import RADIAN
from pipeline.physics.motion import Kinetics, Motion
from pipeline.physics.term import Parameter, Surroundings

FEWEST_WAVES, MOST_WAVES, FINEST = 2.0, 60.0, 0.5
LEAST_TURN = 0.1
PHASE = Parameter("phase", "rad", -4.0 * np.pi, 4.0 * np.pi, 0.0, 0.0)
PHASES = np.arange(4) * np.pi / 4.0
AGAIN, SECOND = "force", "force second"


class ForceWave(ForceTerm):
    """F = size * sin(2 pi x / period + phase); the phase is the last parameter."""

    form = AGAIN

    def scaled(self, values: np.ndarray, factor: float) -> np.ndarray:
        out = super().scaled(values, abs(factor))
        if factor < 0.0:
            out[-1] += np.pi
        return out


class ForceGravity(ForceWave):
    """F = moment * sin(x + phase), x an angle. Source: static moment of a pendulum."""

    name = "gravity"
    place = 170.0
    says = "A weight that is turned pulls by up to {moment}, depending on how it hangs."

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        most = 4.0 * around.angle_span
        own = Parameter("moment", around.angle_unit, 0.0, most, 0.1 * most, 0.1 * most)
        return own, PHASE

    def force(
        self, motion: Motion, kinetics: Kinetics, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray | None]:
        return values[0] * np.sin(motion.drive / motion.radian + values[1]), state

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        own = self.parameters(around)[0].start
        return np.array([[own, phase] for phase in PHASES])

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        least = LEAST_TURN * 2.0 * np.pi * RADIAN.get(around.drive_unit, np.inf)
        return super().excited(motion, around) and around.drive_span > least


class ForceRipple(ForceWave):
    """F = amplitude * sin(2 pi x / period + phase), as of magnets (cogging) or of a screw's turns.

    Form "force second" has a wave of half the period besides: second * sin(4 pi x / period + 2
    phase + second_phase). What comes again less than FEWEST_WAVES times is no ripple to be seen.
    Source: cogging torque, e.g. Hanselman, Brushless Permanent Magnet Motor Design (2003).
    """

    name = "transmission_ripple"
    place = 180.0
    periodic = True
    unlikely = 6.0  # it follows what comes again for any other reason, too
    grows: ClassVar = {AGAIN: (SECOND,)}
    says = "The force swells and ebbs by {amplitude}, again and again every {period}."

    def __init__(self, form: str = AGAIN) -> None:
        self.form = form

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        span, force, unit = around.drive_span, around.angle_span, around.angle_unit
        longest, shortest = span / FEWEST_WAVES, 0.5 * span / MOST_WAVES
        own = (
            Parameter("amplitude", unit, 0.0, force, 0.05 * force, 0.05 * force),
            Parameter("period", around.drive_unit, shortest, longest, longest, 0.0),
        )
        if self.form != SECOND:
            return (*own, PHASE)
        second = Parameter("second", unit, 0.0, force, 0.02 * force, 0.05 * force)
        return (*own, second, replace(PHASE, name="second_phase"), PHASE)

    def force(
        self, motion: Motion, kinetics: Kinetics, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray | None]:
        turned = 2.0 * np.pi * motion.drive / values[1] + values[-1]
        force = values[0] * np.sin(turned)
        if self.form == SECOND:
            force += values[2] * np.sin(2.0 * turned + values[3])
        return force, state

    def scaled(self, values: np.ndarray, factor: float) -> np.ndarray:
        out = super().scaled(values, factor)
        if self.form == SECOND:
            out[2] *= abs(factor)
            out[3] -= np.pi if factor < 0.0 else 0.0
        return out

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        if self.form == SECOND:
            own = [p.start for p in self.parameters(around)]
            return np.array([[*own[:3], turn, own[4]] for turn in 2.0 * PHASES])
        size, span = self.parameters(around)[0].start, around.drive_span
        waves = np.arange(FEWEST_WAVES, MOST_WAVES, FINEST)
        return np.array([[size, span / wave, phase] for wave in waves for phase in PHASES])

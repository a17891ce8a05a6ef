"""Stiffness: a force that grows with the position, like a spring's."""

from typing import ClassVar

import numpy as np

from pipeline.number_words import worded
from pipeline.physics.force_term import ASYMMETRY, ForceTerm, per, size
from pipeline.physics.motion import Kinetics, Motion
from pipeline.physics.pre_sliding import weighted
from pipeline.physics.term import Parameter, Surroundings

MOST = 20.0
POLYTROPIC, FULLEST, STRAIGHT = 1.3, 0.9, 1e-6
FILLED = (-0.6, -0.3, 0.3, 0.6)


def farthest(around: Surroundings) -> float:
    """The largest position of either sign [drive unit]."""
    return max(abs(around.drive_low), abs(around.drive_low + around.drive_span), 1e-12)


class Stiffness(ForceTerm):
    """F = stiffness * x, x the position from its own zero; the rest is part of the offset.

    Forms: "asymmetric" differs for the two sides of zero, x (1 + asymmetry sgn x); "hardening" adds
    a cube, x (1 + hardening x^2); "asymmetric hardening" does both, each to x itself. "gas" is a
    gas of which a way x takes the share filling x of the room that it has at x = 0,
    x -> ((1 - filling x)^-POLYTROPIC - 1) / (POLYTROPIC filling): harder and harder one way, softer
    the other. Source: Hooke's law; Duffing (1918); polytropic change of state, e.g. Bauer,
    Hydropneumatic Suspension Systems (2011).
    """

    name = "stiffness"
    place = 140.0
    grows: ClassVar = {
        "": ("asymmetric", "hardening", "gas"),
        "asymmetric": ("asymmetric hardening",),
        "hardening": ("asymmetric hardening",),
    }
    means = "a force that grows with the position, like a spring's"
    says = "A spring of {stiffness} pushes back."

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        most = 4.0 * around.angle_span / max(around.drive_span, 1e-12)
        own = size("stiffness", per(around, 0), most, around)
        aside = (ASYMMETRY,) if "asymmetric" in self.form else ()
        if "hardening" in self.form:
            far, unit = farthest(around), f"1/{around.drive_unit}^2"
            return (own, *aside, Parameter("hardening", unit, -1.0 / far**2, MOST / far**2, 0.0,
                                           0.5 / far**2))  # fmt: skip
        if self.form == "gas":
            most = FULLEST / farthest(around)
            return (own, Parameter("filling", f"1/{around.drive_unit}", -most, most, 0.0, most))
        return (own, *aside)

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        found = super().candidates(motion, around)
        if self.form == "hardening":
            found = np.repeat(found, 2, axis=0)
            found[1] = found[1, 0] / MOST, MOST / farthest(around) ** 2
        elif self.form == "gas":
            found = np.repeat(found, len(FILLED), axis=0)
            found[:, 1] = np.array(FILLED) / farthest(around)
        return found

    def force(
        self, motion: Motion, kinetics: Kinetics, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray | None]:
        x = motion.drive
        if self.form == "gas":
            return values[0] * compressed(x, float(values[1])), state
        pushed = weighted(x, float(values[1])) if "asymmetric" in self.form else x
        if "hardening" in self.form:
            pushed = pushed + values[-1] * x**3
        return values[0] * pushed, state

    def sentence(self, values: np.ndarray, around: Surroundings) -> str:
        told = super().sentence(values, around)
        if self.form != "gas":
            return told
        way = "rises" if values[1] > 0.0 else "falls"
        share = worded(100.0 * abs(values[1]) * farthest(around))
        return (
            f"{told[:-1]}, and harder and harder as the position {way}: a gas, of which the way to "
            f"the farther end takes {share} % of the room that it has at 0."
        )


def compressed(x: np.ndarray, filling: float) -> np.ndarray:
    """How a gas pushes back by the way (n,), as steeply as that where it is 0."""
    taken = filling * x
    if np.max(np.abs(taken), initial=0.0) < STRAIGHT:
        return x
    return np.asarray(((1.0 - taken) ** -POLYTROPIC - 1.0) / (POLYTROPIC * filling))

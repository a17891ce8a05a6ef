"""Ripple: a periodic error over the shaft angle (eccentric pulley, gear teeth)."""

from dataclasses import replace
from typing import ClassVar

import numpy as np
from numba import njit

from pipeline.number_words import worded
from pipeline.physics.force_units import FORCES
from pipeline.physics.motion import Motion
from pipeline.physics.tabled import waved
from pipeline.physics.term import NO_STATE, Parameter, Surroundings, Term

OVERTONES = {"second": (2,), "third": (3,), "both": (2, 3), "odd": (3,), "all": (2, 3)}
EDGES = 3.0
TWO, APART = "two afloat", 1.5
SWELLING, DEEPEST, SLOWEST = "swelling afloat", 0.95, 3.0
ECCENTRIC, FARTHEST, CENTRED = "eccentric afloat", 0.9, 1e-6
GOING_ON = {"odd": (5, 7, 9), "all": (4, 5, 6, 7, 8)}


@njit(cache=True, fastmath=True, error_model="numpy")
def rippled(drive, turn, waves):  # type: ignore[no-untyped-def]
    """drive + the sum of amplitude sin(times turn drive + phase) over waves (k, 3), (n,)."""
    out = drive.copy()
    for times, amplitude, phase in waves:
        if amplitude != 0.0:
            for i in range(drive.size):
                out[i] += amplitude * waved(times * turn * drive[i] + phase)[0]
    return out


def swelling(
    amplitude: float, period: float, phase: float, swell: float, slow: float, at: float
) -> np.ndarray:
    """A wave that swells and fades, as a wave and its two side bands: `rippled`'s waves, (3, 3)."""
    side, beat, half = 0.5 * swell * amplitude, period / slow, 0.5 * np.pi
    return np.array(
        [
            [1.0, amplitude, phase],
            [1.0 - beat, side, phase - at + half],
            [1.0 + beat, side, phase + at - half],
        ]
    )


def off_centre(
    drive: np.ndarray, amplitude: float, period: float, phase: float, eccentricity: float
) -> np.ndarray:
    """How far a wheel runs ahead that turns about a point off its centre, (n,)."""
    turned = 2.0 * np.pi * drive / period + phase
    aside, along = eccentricity * np.sin(turned), 1.0 - eccentricity * np.cos(turned)
    if abs(eccentricity) < CENTRED:
        return np.asarray(amplitude * np.sin(turned))
    return np.asarray(amplitude / eccentricity * np.arctan2(aside, along))


class TransmissionRipple(Term):
    """x = u + a (sin(2 pi u / period + phase) - sin(phase)): the error counts from drive 0.

    In the form "second" with its second harmonic too, in the form "third" with its third, as teeth
    that change over in steps leave it, in the form "both" with both. In the forms "afloat" without
    - sin(phase): the zero was not taken where the drive is 0, and where the nominal curve bends
    that is more than an offset. In the forms "odd" and "all" the overtones of "third" and "both" go
    on, each `further` times the one before and as far ahead of it in phase, as what snaps over has
    them: teeth that seat, a wave with edges. In the form "two afloat" two waves, each of a period
    of its own: the teeth of a gear and the pulley that it turns, or the gears of two stages. In the
    form "eccentric afloat" a wheel turns about a point off its centre: amplitude / eccentricity
    atan2(eccentricity sin a, 1 - eccentricity cos a), a = 2 pi u / period + phase. In the form
    "swelling afloat" teeth run out of true: amplitude (1 + swell sin(2 pi u / swell_period +
    swell_phase)) sin(2 pi u / period + phase).
    A period that the drive does not run through at least once and a third is no ripple to be seen,
    and edges that it does not meet three times are not told from a single one; of two
    waves, one that it runs through less than one and a half times is a bend beside the other, and
    two that fall out of step less often than that are one that swells at some place.
    Source: kinematic transmission error, e.g. Tuttle and Seering, IEEE Trans. Robotics and
    Automation 12(3) (1996) 368.
    """

    name = "transmission_ripple"
    site = "actuator"
    place = 20.0
    periodic = True
    before_curve = True
    grows: ClassVar = {
        "first": (
            "first afloat",
            "second",
            "second afloat",
            "third afloat",
            TWO,
            SWELLING,
            ECCENTRIC,
        ),
        "first afloat": ("second afloat", "third afloat", TWO, SWELLING, ECCENTRIC),
        "second": ("second afloat", "both afloat", TWO),
        "second afloat": ("both afloat", TWO),
        "third afloat": ("both afloat", "odd afloat", TWO),
        "both afloat": ("all afloat",),
    }
    means = "a periodic error over the shaft angle: eccentric pulley, gear teeth"
    says = (
        "The drive runs ahead and behind by {amplitude}, again and again every {period} of shaft."
    )

    def __init__(self, form: str = "first") -> None:
        self.form = form
        self.overtones = OVERTONES.get(form.removesuffix(" afloat"), ())
        self.going_on = GOING_ON.get(form.removesuffix(" afloat"), ())
        self.scanned = form in (TWO, SWELLING)

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        span, unit = around.drive_span, around.drive_unit
        longest = span / EDGES if self.going_on else 0.75 * span
        own: tuple[Parameter, ...] = (
            Parameter("amplitude", unit, 0.0, 0.3 * span, 0.02 * span, 0.01 * span),
            Parameter("period", unit, 2.0 * around.spacing, longest, 0.4 * longest, 0.0),
            Parameter("phase", "rad", -4.0 * np.pi, 4.0 * np.pi, 0.0, 0.0),
        )
        for times in self.overtones:
            own += (
                Parameter(f"amplitude_{times}", unit, 0.0, 0.3 * span, 0.005 * span, 0.01 * span),
                Parameter(f"phase_{times}", "rad", -4.0 * np.pi, 4.0 * np.pi, 0.0, 0.0),
            )
        if self.form == TWO:
            own += tuple(replace(p, name=f"other_{p.name}") for p in own)
        if self.form == SWELLING:
            own += (
                Parameter("swell", "", 0.0, DEEPEST, 0.2, 0.3),
                Parameter("swell_period", unit, 0.2 * span, 2.0 * span, 0.5 * span, 0.0),
                Parameter("swell_phase", "rad", -4.0 * np.pi, 4.0 * np.pi, 0.0, 0.0),
            )
        if self.form == ECCENTRIC:
            own += (Parameter("eccentricity", "", -FARTHEST, FARTHEST, 0.3, 0.3),)
        if self.going_on:
            own += (Parameter("further", "", 0.0, 1.0, 0.5, 0.3),)
        return own

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        if self.form == ECCENTRIC:
            return signal + off_centre(signal, *values), NO_STATE
        waves = self.waves(values)
        out = rippled(np.ascontiguousarray(signal), 2.0 * np.pi / values[1], waves)
        if "afloat" not in self.form:
            out -= float(waves[:, 1] @ np.sin(waves[:, 2]))
        return out, NO_STATE

    def waves(self, values: np.ndarray) -> np.ndarray:
        """How often each wave comes in a period, its amplitude and its phase, (k, 3)."""
        if self.form == TWO:
            amplitude, period, phase, other, its_period, its_phase = values
            return np.array([[1.0, amplitude, phase], [period / its_period, other, its_phase]])
        if self.form == SWELLING:
            return swelling(*values)
        told = 1 + len(self.overtones)
        out = np.empty((told + len(self.going_on), 3))
        out[:, 0] = (1.0, *self.overtones, *self.going_on)
        out[0, 1:] = values[0], values[2]
        out[1:told, 1:] = values[3 : 1 + 2 * told].reshape(-1, 2)
        if self.going_on:
            on = np.arange(1, 1 + len(self.going_on))
            last, before = out[told - 1], out[told - 2]
            out[told:, 1] = last[1] * values[-1] ** on
            out[told:, 2] = last[2] + on * (last[2] - before[2])
        return out

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        span, amplitude = around.drive_span, 0.002 * around.drive_span
        highest = min(0.25 / max(around.spacing, 1e-9), 30.0 / span)
        fewest = EDGES if self.going_on else 1.4
        waves = np.arange(fewest / span, highest, 0.5 / span)
        phases = np.arange(4) * np.pi / 4.0
        rows = [[amplitude, 1.0 / f, p] for f in waves for p in phases]
        if self.form == TWO:
            first = [p.start for p in self.parameters(around)[:3]]
            return np.array([[*first, *r] for r in rows])
        if self.form == SWELLING:
            first = [p.start for p in self.parameters(around)[:3]]
            slow = np.arange(0.5, SLOWEST, 0.25) / span
            return np.array([[*first, 0.2, 1.0 / f, 2.0 * p] for f in slow for p in phases])
        if self.form == ECCENTRIC:
            return np.array([[*r, e] for r in rows for e in (-0.3, 0.3)])
        for _ in self.overtones:
            rows = [[*r, 0.3 * amplitude, p] for r in rows for p in np.arange(4) * np.pi / 2.0]
        if self.going_on:
            rows = [[*r, 0.5] for r in rows]
        return np.array(rows).reshape(len(rows), -1)

    def scaled(self, values: np.ndarray, factor: float) -> np.ndarray:
        out = super().scaled(values, abs(factor))
        if factor < 0.0:
            out[2] += np.pi
        return out

    def resized(self, values: np.ndarray, factor: float) -> np.ndarray:
        if self.form == SWELLING:
            turned = 0.0 if factor >= 0.0 else np.pi
            swell = min(abs(factor) * values[3], DEEPEST)
            return np.array([*values[:3], swell, values[4], values[5] + turned])
        return np.concatenate([values[:3], self.scaled(values[3:], factor)])

    def slight(self, values: np.ndarray, around: Surroundings) -> bool:
        if self.form != TWO:
            return False
        first, other = around.drive_span / values[[1, 4]]
        return bool(min(first, other, abs(first - other)) < APART)

    def retold(self, starts: np.ndarray) -> np.ndarray:
        """Of two waves the long one may be the second harmonic of a longer one still."""
        if self.overtones != (2,):
            return starts
        longer = starts[:, [3, 1, 4, 0, 2]] * [1.0, 2.0, 1.0, 1.0, 1.0]
        return np.vstack([starts, longer])

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        """Where a shaft drives, far enough; a force has no teeth."""
        far = 4.0 * EDGES if self.going_on else 8.0
        return around.drive_unit not in FORCES and around.drive_span > far * around.spacing > 0.0

    def sentence(self, values: np.ndarray, around: Surroundings) -> str:
        """Of several waves the largest one is told."""
        waves = self.waves(values)
        times, amplitude, _ = waves[np.argmax(waves[:, 1])]
        told = np.concatenate([[amplitude, values[1] / times], values[2:]])
        said = super().sentence(told, around)
        unit = around.drive_unit
        if self.form == SWELLING:
            return f"{said} It swells and fades every {worded(values[4])} {unit}."
        if self.form == ECCENTRIC:
            return f"{said} It is uneven, as a wheel's that turns about a point off its centre."
        if self.form != TWO:
            return said
        other, period = (waves[np.argmin(waves[:, 1]), k] for k in (1, 0))
        return (
            f"{said} Beside that it does so by {worded(other)} {unit}, "
            f"every {worded(values[1] / period)} {unit}."
        )

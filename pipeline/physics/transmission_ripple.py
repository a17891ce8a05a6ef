"""Ripple: a periodic error over the shaft angle (eccentric pulley, gear teeth)."""

from typing import ClassVar

import numpy as np
from numba import njit

from pipeline.physics.force_units import FORCES
from pipeline.physics.motion import Motion
from pipeline.physics.tabled import waved
from pipeline.physics.term import NO_STATE, Parameter, Surroundings, Term

OVERTONES = {"second": (2,), "third": (3,), "both": (2, 3), "odd": (3,), "all": (2, 3)}
EDGES = 3.0
MOST_OFTEN = 0.3  # per step of the drive: 0.5 is no wave to be seen
COINCIDENCE, ALIKE = 1e4, 0.03  # periods
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


class TransmissionRipple(Term):
    """x = u + a (sin(2 pi u / period + phase) - sin(phase)): the error counts from drive 0.

    In the form "second" with its second harmonic too, in the form "third" with its third, as teeth
    that change over in steps leave it, in the form "both" with both. In the forms "afloat" without
    - sin(phase): the zero was not taken where the drive is 0, and where the nominal curve bends
    that is more than an offset. In the forms "odd" and "all" the overtones of "third" and "both" go
    on, each `further` times the one before and as far ahead of it in phase, as what snaps over has
    them: teeth that seat, a wave with edges.
    A period that the drive does not run through at least once and a third is no ripple to be seen,
    and edges that it does not meet three times are not told from a single one.
    Source: kinematic transmission error, e.g. Tuttle and Seering, IEEE Trans. Robotics and
    Automation 12(3) (1996) 368.
    """

    name = "transmission_ripple"
    form = "first"
    site = "actuator"
    place = 20.0
    periodic = True
    before_curve = True
    grows: ClassVar = {
        "first": ("first afloat", "second", "second afloat", "third afloat"),
        "first afloat": ("second afloat", "third afloat"),
        "second": ("second afloat", "both afloat"),
        "second afloat": ("both afloat",),
        "third afloat": ("both afloat", "odd afloat"),
        "both afloat": ("all afloat",),
    }
    means = "a periodic error over the shaft angle: eccentric pulley, gear teeth"
    says = (
        "The drive runs ahead and behind by {amplitude}, again and again every {period} of shaft."
    )

    def __init__(self, form: str = "") -> None:
        super().__init__(form)
        self.overtones = OVERTONES.get(self.form.removesuffix(" afloat"), ())
        self.going_on = GOING_ON.get(self.form.removesuffix(" afloat"), ())

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
        if self.going_on:
            own += (Parameter("further", "", 0.0, 1.0, 0.5, 0.3),)
        return own

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        waves = self.waves(values)
        out = rippled(np.ascontiguousarray(signal), 2.0 * np.pi / values[1], waves)
        if "afloat" not in self.form:
            out -= float(waves[:, 1] @ np.sin(waves[:, 2]))
        return out, NO_STATE

    def waves(self, values: np.ndarray) -> np.ndarray:
        """How often each wave comes in a period, its amplitude and its phase, (k, 3)."""
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

    def plain_waves(self, around: Surroundings) -> np.ndarray:
        """Amplitude, period and phase of waves to begin a search from, (k, 3)."""
        span = around.drive_span
        highest = min(MOST_OFTEN / max(around.spacing, 1e-9), 30.0 / span)
        often = np.arange((EDGES if self.going_on else 1.4) / span, highest, 0.5 / span)
        phases = np.arange(4) * np.pi / 4.0
        rows = [[0.002 * span, 1.0 / f, p] for f in often for p in phases]
        return np.array(rows).reshape(len(rows), 3)

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        rows, turns = self.plain_waves(around), np.arange(4) * np.pi / 2.0
        overtones = np.column_stack([np.full(4, 0.0006 * around.drive_span), turns])
        for _ in self.overtones:
            rows = np.hstack([np.repeat(rows, 4, axis=0), np.tile(overtones, (len(rows), 1))])
        further = np.full((len(rows), len(self.going_on) and 1), 0.5)
        return np.hstack([rows, further])

    def scaled(self, values: np.ndarray, factor: float) -> np.ndarray:
        out = super().scaled(values, abs(factor))
        if factor < 0.0:
            out[2] += np.pi
        return out

    def chance(self, values: np.ndarray, motion: Motion) -> float:
        """A wave of which the stairs that a drive takes are whole ones is met in passing only."""
        if motion.stair == 0.0:
            return 0.0
        waves = self.waves(values)
        often = motion.stair / values[1] * float(waves[np.argmax(np.abs(waves[:, 1])), 0])
        return COINCIDENCE if often > 0.5 and abs(often - round(often)) < ALIKE else 0.0

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
        return super().sentence(told, around)

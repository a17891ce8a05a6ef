"""Ripple: a periodic error over the shaft angle (eccentric pulley, gear teeth)."""

from typing import ClassVar

import numpy as np
from numba import njit

from pipeline.physics.force_units import FORCES
from pipeline.physics.motion import Motion
from pipeline.physics.tabled import waved
from pipeline.physics.term import NO_STATE, Parameter, Surroundings, Term


@njit(cache=True, fastmath=True, error_model="numpy")
def rippled(drive, turn, amplitude, phase, further, later, times):  # type: ignore[no-untyped-def]
    """drive + amplitude sin(turn drive + phase) + further sin(times turn drive + later), (n,)."""
    out = np.empty(drive.size)
    for i in range(drive.size):
        angle = turn * drive[i]
        out[i] = drive[i] + amplitude * waved(angle + phase)[0]
    if further != 0.0:
        for i in range(drive.size):
            out[i] += further * waved(times * turn * drive[i] + later)[0]
    return out


class TransmissionRipple(Term):
    """x = u + a (sin(2 pi u / period + phase) - sin(phase)): the error counts from drive 0.

    In the form "second" with its second harmonic too, in the form "third" with its third, as teeth
    that change over in steps leave it. In the forms "afloat" without - sin(phase):
    the zero was not taken where the drive is 0, and where the nominal curve bends that is more than
    an offset.
    A period that the drive does not run through at least once and a third is no ripple to be seen.
    Source: kinematic transmission error, e.g. Tuttle and Seering, IEEE Trans. Robotics and
    Automation 12(3) (1996) 368.
    """

    name = "transmission_ripple"
    site = "actuator"
    before_curve = True
    grows: ClassVar = {
        "first": ("first afloat", "second", "second afloat", "third afloat"),
        "first afloat": ("second afloat", "third afloat"),
        "second": ("second afloat",),
    }
    says = (
        "The drive runs ahead and behind by {amplitude}, again and again every {period} of shaft."
    )

    def __init__(self, form: str = "first") -> None:
        self.form = form
        self.times = {"second": 2, "third": 3}.get(form.removesuffix(" afloat"), 1)

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        span, unit = around.drive_span, around.drive_unit
        own = (
            Parameter("amplitude", unit, 0.0, 0.3 * span, 0.02 * span, 0.01 * span),
            Parameter("period", unit, 2.0 * around.step, 0.75 * span, 0.3 * span, 0.0),
            Parameter("phase", "rad", -4.0 * np.pi, 4.0 * np.pi, 0.0, 0.0),
        )
        if self.times == 1:
            return own
        size, phase = f"amplitude_{self.times}", f"phase_{self.times}"
        return (
            *own,
            Parameter(size, unit, 0.0, 0.3 * span, 0.005 * span, 0.01 * span),
            Parameter(phase, "rad", -4.0 * np.pi, 4.0 * np.pi, 0.0, 0.0),
        )

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        amplitude, period, phase, further, later = (*values, 0.0, 0.0)[:5]
        turn, times = 2.0 * np.pi / period, float(self.times)
        out = rippled(np.ascontiguousarray(signal), turn, amplitude, phase, further, later, times)
        if "afloat" not in self.form:
            out -= amplitude * np.sin(phase) + further * np.sin(later)
        return out, NO_STATE

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        span, amplitude = around.drive_span, 0.002 * around.drive_span
        highest = min(0.25 / max(around.step, 1e-9), 30.0 / span)
        waves = np.arange(1.4 / span, highest, 0.5 / span)
        phases = np.arange(4) * np.pi / 4.0
        rows = [[amplitude, 1.0 / f, p] for f in waves for p in phases]
        if self.times > 1:
            second = [[0.3 * amplitude, p] for p in np.arange(4) * np.pi / 2.0]
            rows = [[*r, *s] for r in rows for s in second]
        return np.array(rows).reshape(len(rows), -1)

    def scaled(self, values: np.ndarray, factor: float) -> np.ndarray:
        out = super().scaled(values, abs(factor))
        if factor < 0.0:
            out[2] += np.pi
        return out

    def retold(self, starts: np.ndarray) -> np.ndarray:
        """Of two waves the long one may be the second harmonic of a longer one still."""
        if self.times != 2:
            return starts
        longer = starts[:, [3, 1, 4, 0, 2]] * [1.0, 2.0, 1.0, 1.0, 1.0]
        return np.vstack([starts, longer])

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        """Where a shaft drives, far enough; a force has no teeth."""
        return around.drive_unit not in FORCES and around.drive_span > 8.0 * around.step > 0.0

    def sentence(self, values: np.ndarray, around: Surroundings) -> str:
        """Of two waves the larger one is told."""
        if self.times > 1 and values[3] > values[0]:
            values = np.concatenate([[values[3], values[1] / self.times], values[2:]])
        return super().sentence(values, around)

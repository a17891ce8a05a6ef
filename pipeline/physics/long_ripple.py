"""A ripple of which the drive runs through hardly more than one wave: a pulley off its centre."""

from dataclasses import replace
from typing import ClassVar

import numpy as np

from pipeline.physics.term import Parameter, Surroundings
from pipeline.physics.transmission_ripple import TransmissionRipple

SHORTEST, LONGEST, STARTS = 0.75, 2.0, 6
UNUSUAL = 12.0


class LongRipple(TransmissionRipple):
    """x = u + a sin(2 pi u / period + phase), its wave SHORTEST to LONGEST of the drive's range.

    Longer ones bend as a parabola or a cubic does, and so as a camera's view or a weight may.
    Source: as of one ripple.
    """

    form = "long afloat"
    grows: ClassVar = {}
    unlikely = UNUSUAL  # most bends are a joint's or a camera's

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        amplitude, period, phase = super().parameters(around)
        low, high = SHORTEST * around.drive_span, LONGEST * around.drive_span
        return amplitude, replace(period, low=low, high=high, start=0.5 * (low + high)), phase

    def plain_waves(self, around: Surroundings) -> np.ndarray:
        span, turns = around.drive_span, np.arange(4) * np.pi / 4.0
        often = np.linspace(1.0 / LONGEST, 1.0 / SHORTEST, STARTS) / span
        return np.array([[0.01 * span, 1.0 / f, turn] for f in often for turn in turns])

"""Two ripples of two periods: the teeth of a gear and its wheel, or the gears of two stages."""

from dataclasses import replace
from typing import ClassVar

import numpy as np

from pipeline.number_words import worded
from pipeline.physics.motion import Motion
from pipeline.physics.term import Parameter, Surroundings
from pipeline.physics.transmission_ripple import TransmissionRipple

ONCE, APART = 1.5, 0.75


class TwoRipples(TransmissionRipple):
    """x = u + a sin(2 pi u / period + phase) + b sin(2 pi u / other_period + other_phase).

    A wave that the drive runs through less than ONCE (and a half) is a bend beside the other, and
    two that fall out of step less often than APART are one that swells at some place.
    Source: as of one ripple.
    """

    form = "two afloat"
    scanned = True
    grows: ClassVar = {}

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        own = super().parameters(around)
        return own + tuple(replace(p, name=f"other_{p.name}") for p in own)

    def waves(self, values: np.ndarray) -> np.ndarray:
        amplitude, period, phase, other, its_period, its_phase = values
        return np.array([[1.0, amplitude, phase], [period / its_period, other, its_phase]])

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        first = [p.start for p in super().parameters(around)]
        return np.array([[*first, *row] for row in self.plain_waves(around)])

    def resized(self, values: np.ndarray, factor: float) -> np.ndarray:
        return np.concatenate([values[:3], self.scaled(values[3:], factor)])

    def slight(self, values: np.ndarray, around: Surroundings) -> bool:
        first, other = around.drive_span / values[[1, 4]]
        return bool(min(first, other) < ONCE or abs(first - other) < APART)

    def sentence(self, values: np.ndarray, around: Surroundings) -> str:
        waves, unit = self.waves(values), around.drive_unit
        other, period = (waves[np.argmin(waves[:, 1]), k] for k in (1, 0))
        return (
            f"{super().sentence(values, around)} Beside that it does so by {worded(other)} {unit}, "
            f"every {worded(values[1] / period)} {unit}."
        )

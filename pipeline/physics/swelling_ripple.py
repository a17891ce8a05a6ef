"""A ripple that swells and fades: teeth that run out of true."""

from typing import ClassVar

import numpy as np

from pipeline.number_words import worded
from pipeline.physics.motion import Motion
from pipeline.physics.term import Parameter, Surroundings
from pipeline.physics.transmission_ripple import TransmissionRipple

DEEPEST, SLOWEST = 0.95, 3.0


class SwellingRipple(TransmissionRipple):
    """x = u + a (1 + swell sin(2 pi u / swell_period + swell_phase)) sin(2 pi u / period + phase).

    As a wave and its two side bands. Source: as of one ripple.
    """

    form = "swelling afloat"
    scanned = True
    grows: ClassVar = {}

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        span, unit = around.drive_span, around.drive_unit
        return (
            *super().parameters(around),
            Parameter("swell", "", 0.0, DEEPEST, 0.2, 0.3),
            Parameter("swell_period", unit, 0.2 * span, 2.0 * span, 0.5 * span, 0.0),
            Parameter("swell_phase", "rad", -4.0 * np.pi, 4.0 * np.pi, 0.0, 0.0),
        )

    def waves(self, values: np.ndarray) -> np.ndarray:
        amplitude, period, phase, swell, slow, at = values
        side, beat, half = 0.5 * swell * amplitude, period / slow, 0.5 * np.pi
        return np.array(
            [
                [1.0, amplitude, phase],
                [1.0 - beat, side, phase - at + half],
                [1.0 + beat, side, phase + at - half],
            ]
        )

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        first = [p.start for p in super().parameters(around)]
        often = np.arange(0.5, SLOWEST, 0.25) / around.drive_span
        turns = np.arange(4) * np.pi / 2.0
        return np.array([[*first, 0.2, 1.0 / f, turn] for f in often for turn in turns])

    def resized(self, values: np.ndarray, factor: float) -> np.ndarray:
        turned = 0.0 if factor >= 0.0 else np.pi
        swell = min(abs(factor) * values[3], DEEPEST)
        return np.array([*values[:3], swell, values[4], values[5] + turned])

    def sentence(self, values: np.ndarray, around: Surroundings) -> str:
        every = f"{worded(values[4])} {around.drive_unit}"
        return f"{super().sentence(values, around)} It swells and fades every {every}."

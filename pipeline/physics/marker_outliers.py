"""Marker outliers: frames in which the marker was mistaken."""

import numpy as np

from pipeline.physics.motion import Motion
from pipeline.physics.term import Parameter, Surroundings, Term


class MarkerOutliers(Term):
    """In a share of the samples the seen angle is off by +-size, without memory.

    Which samples is drawn from the count of samples (fixed seed), so that a block-wise answer is
    the same. A diagnosis finds the rows themselves and never fits this response. Source: two-point
    contamination.
    """

    name = "marker_outliers"
    site = "sensor"
    place = 240.0
    means = "frames in which the marker was mistaken"
    says = "In {share} of the frames another thing was taken for the marker, about {size} off."

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        return (
            Parameter("share", "", 0.0, 0.3, 0.02, 0.02),
            Parameter("size", around.angle_unit, 0.0, 4 * around.angle_span, 5.0, 5.0),
        )

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        begin = 0 if state is None else int(state[0])
        count = begin + np.arange(len(signal))
        draw = np.modf(np.abs(np.sin(12.9898 * (count + 1.0)) * 43758.5453))[0]
        sign = np.where(draw < 0.5 * values[0], -1.0, 1.0)
        return signal + sign * values[1] * (draw < values[0]), np.array([begin + len(signal)])

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        return True

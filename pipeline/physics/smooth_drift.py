"""A zero that wanders smoothly, wherever it goes."""

import numpy as np
from numpy.polynomial.chebyshev import chebval

from pipeline.physics.drift import Drift, duration_s
from pipeline.physics.motion import Motion
from pipeline.physics.term import Parameter, Surroundings
from pipeline.physics.waving_drift import shortest_s

WAVES, REACH, FINELY = 7, 0.8, 1001
PARTS = 1 + WAVES


def series(share: np.ndarray) -> np.ndarray:
    """1, (1 - s)^2 and cos(k pi s), k = 1 to WAVES, of shares s of a recording, (n, 1 + PARTS)."""
    waves = np.cos(np.pi * np.outer(share, np.arange(1, WAVES + 1)))
    return np.column_stack([share**0, (1.0 - share) ** 2, waves])


GRID = series(np.linspace(0.0, 1.0, FINELY))
ALONE = np.sqrt(FINELY) * np.linalg.inv(np.linalg.qr(GRID, mode="r"))[:, 1:]
"""What makes orthogonal parts of mean square 1 of the series' columns (Gram-Schmidt)."""


class SmoothDrift(Drift):
    """d = sum of rms_k (b_k(s) - b_k(0)), s = t / until, k = 1 to PARTS; held from `until` on.

    The b_k are `series` made orthogonal over the recording, which ends at `until`, each of an rms
    of 1. It is tried where the quickest wave is as slow as a drift's may be, and the rows to fit on
    go on nearly to the end: after them nothing holds it, but that it comes to rest at the end.
    Source: the cosine series of a smooth function on an interval (Fourier), with a parabola for its
    slope at the start, which that alone follows slowly (Lanczos, Discourse on Fourier Series
    (1966)).
    """

    form = "smooth"
    unlikely = 3.0  # as a wave
    says = "The zero wanders to and fro while it runs, slowly, and follows no simple course."

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        span, unit, whole = around.angle_span, around.angle_unit, duration_s(around)
        return (
            *(
                Parameter(f"rms_{k}", unit, -span, span, 0.01 * span, 0.03 * span, measured=True)
                for k in range(1, PARTS + 1)
            ),
            Parameter("until", "s", whole, whole, whole, 0.0, weak=True),
        )

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        first = motion.time_s[:1] if state is None else state
        share = np.clip((motion.time_s - first[0]) / values[-1], 0.0, 1.0)
        _, bow, *waves = ALONE @ values[:-1]
        wandered = bow * ((1.0 - share) ** 2 - 1.0)
        wandered += chebval(np.cos(np.pi * share), [-sum(waves), *waves])
        return signal + wandered, first

    def scaled(self, values: np.ndarray, factor: float) -> np.ndarray:
        return np.append(values[:-1] * factor, values[-1])

    def void(self, values: np.ndarray) -> bool:
        return not np.any(values[:-1])

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        whole_s = duration_s(around)
        slow = 2.0 * whole_s / WAVES >= shortest_s(around)
        reaches = float(np.ptp(motion.time_s)) > REACH * whole_s
        return slow and reaches and super().excited(motion, around)

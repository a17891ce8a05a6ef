"""Calibration: gain, offset and a smooth curve error, as nuisances with declared tolerances."""

from dataclasses import dataclass

import numpy as np

from pipeline.config import ToleranceConfig

SHAPE_ORDERS = (2, 3, 4)


@dataclass(frozen=True)
class Nuisances:
    """measurement = gain * a + offset + sum_k bend_k P_k(a), a the mechanism's angle.

    P_k are Legendre polynomials (orders 2 to 4) over the simulated range: free of gain and offset,
    1 at an end of the range. Gain, offset and bends have Gaussian priors about 1, 0 and 0.
    """

    middle: float
    half_range: float
    deviations: np.ndarray

    @property
    def expected(self) -> np.ndarray:
        """Prior means, (m,): gain, offset, bends."""
        return np.eye(1, len(self.deviations))[0]

    def columns(self, angle: np.ndarray) -> np.ndarray:
        """What gain, offset and bends multiply, (n, m)."""
        out = np.empty((len(angle), len(self.deviations)))
        out[:, 0] = angle
        out[:, 1] = 1.0
        if out.shape[1] > 2:
            x = (angle - self.middle) / self.half_range
            square = x * x
            out[:, 2] = 1.5 * square - 0.5
            out[:, 3] = x * (2.5 * square - 1.5)
            out[:, 4] = (4.375 * square - 3.75) * square + 0.375
        return out


def nuisances_of(tolerance: ToleranceConfig, angle_low: float, angle_span: float) -> Nuisances:
    """The nuisances that a configuration declares; no bends where `shape` is 0."""
    half = max(0.5 * angle_span, 1e-9)
    deviations = [max(tolerance.gain, 1e-9), max(tolerance.offset, 1e-9)]
    if tolerance.shape > 0.0:
        deviations += len(SHAPE_ORDERS) * [tolerance.shape]
    return Nuisances(angle_low + half, half, np.array(deviations))

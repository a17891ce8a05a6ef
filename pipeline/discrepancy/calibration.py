"""Calibration: gain, offset and a smooth curve error, as nuisances with declared tolerances."""

from dataclasses import dataclass

import numpy as np

from pipeline.config import ToleranceConfig
from pipeline.physics.kinematics import SmoothError, legendre
from pipeline.physics.mechanism import Trace

SHAPES = 3


@dataclass(frozen=True)
class Nuisances:
    """measurement = gain * seen + offset + sum_k bend_k P_k(seen), see `Mechanism.trace`.

    P_k are Legendre polynomials (orders 2 to 4) over the simulated range, see `SmoothError`. Gain,
    offset and bends have Gaussian priors about 1, 0 and 0.
    """

    middle: float
    half_range: float
    deviations: np.ndarray

    @property
    def expected(self) -> np.ndarray:
        """Prior means, (m,): gain, offset, bends."""
        return np.eye(1, len(self.deviations))[0]

    def columns(self, trace: Trace) -> np.ndarray:
        """What gain, offset and bends multiply, (n, m)."""
        out = np.empty((len(trace.seen), len(self.deviations)))
        own = trace.seen if trace.added is None else trace.seen - trace.added
        out[:, 0] = own
        out[:, 1] = 1.0
        if out.shape[1] > 2:
            out[:, 2:] = legendre((own - self.middle) / self.half_range)
        return out

    def answer(self, trace: Trace, nuisance: np.ndarray) -> np.ndarray:
        """What is measured, (n,), by a trace and nuisances (m,)."""
        calibrated = self.columns(trace) @ nuisance
        return calibrated if trace.added is None else calibrated + trace.added

    def error(self, nuisance: np.ndarray) -> SmoothError | None:
        """The smooth error that fitted nuisances (m,) amount to; None where none is allowed."""
        if len(nuisance) < 3:
            return None
        weights = (float(nuisance[2]), float(nuisance[3]), float(nuisance[4]))
        return SmoothError(self.middle, self.half_range, weights)


def nuisances_of(tolerance: ToleranceConfig, angle_low: float, angle_span: float) -> Nuisances:
    """The nuisances that a configuration declares; no bends where `shape` is 0."""
    half = max(0.5 * angle_span, 1e-9)
    deviations = [max(tolerance.gain, 1e-9), max(tolerance.offset, 1e-9)]
    if tolerance.shape > 0.0:
        deviations += SHAPES * [tolerance.shape]
    return Nuisances(angle_low + half, half, np.array(deviations))

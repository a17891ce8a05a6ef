"""Calibration: gain, offset and a smooth curve error, as nuisances with declared tolerances."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from pipeline.config import ToleranceConfig
from pipeline.physics.kinematics import Beside, SmoothError, smooth_columns
from pipeline.physics.mechanism import Trace

SHAPES = 3
# Deviations that a tolerance of gain or offset is: it holds 19 times in 20. Of a force the gain is
# that of a whole law, of which a damping is known less well than a geometry: twice in three times.
IN_TOLERANCE, FORCE_IN_TOLERANCE = 2.0, 1.0
FAR_OFF = 5.0  # tolerances beyond which a calibration refutes what was declared
ABSURD = 2.0  # a gain off by more than this factor speaks of units or wiring
FOLLOWS = 0.7  # share of the variance from which on a line is a gain


@dataclass(frozen=True)
class Nuisances:
    """measurement = gain * seen + offset + smooth error, see `Mechanism.trace` and `SmoothError`.

    Gain, the offset that it leaves at `zero`, and the smooth error's weights have Gaussian priors
    of `deviations` about 1, 0 and 0; two deviations stand for no smooth error. zero: from
    which simulated angle they count, see `zero_of`: far from there a gain makes an offset of its
    own. beside: other commands that the smooth error may depend on.
    """

    middle: float
    half_range: float
    deviations: np.ndarray
    beside: tuple[Beside, ...] = ()
    zero: float = 0.0

    @cached_property
    def judged(self) -> np.ndarray:
        """Of nuisances those that priors are of, (m, m): of the offset that at `zero`."""
        seen = np.eye(len(self.deviations))
        seen[1, 0] = self.zero
        return seen

    @property
    def held(self) -> np.ndarray:
        """What makes nuisances' distance from their prior means one of unit deviations, (m, m)."""
        return self.judged / self.deviations[:, None]

    @cached_property
    def precision(self) -> np.ndarray:
        """Of the priors of gain, offset and weights, (m, m)."""
        return np.asarray(self.judged.T / self.deviations**2 @ self.judged)

    @property
    def straight(self) -> bool:
        """Whether gain and offset are all."""
        return len(self.deviations) == 2

    def offset(self, nuisance: np.ndarray) -> float:
        """The offset at `zero` that nuisances (m,) amount to."""
        return float(nuisance[1] + (nuisance[0] - 1.0) * self.zero)

    @cached_property
    def expected(self) -> np.ndarray:
        """Prior means, (m,): gain, offset, weights."""
        return np.eye(1, len(self.deviations))[0]

    def columns(self, trace: Trace, others: Mapping[str, np.ndarray]) -> np.ndarray:
        """What gain, offset and weights multiply, (n, m); others: the other commands."""
        out = np.empty((len(trace.seen), len(self.deviations)))
        own = trace.seen if trace.added is None else trace.seen - trace.added
        out[:, 0] = own
        out[:, 1] = 1.0
        if out.shape[1] > 2:
            out[:, 2:] = smooth_columns(own, others, self.middle, self.half_range, self.beside)
        return out

    def answer(
        self, trace: Trace, nuisance: np.ndarray, others: Mapping[str, np.ndarray]
    ) -> np.ndarray:
        """What is measured, (n,), by a trace and nuisances (m,)."""
        if self.straight and trace.added is None:
            return np.asarray(nuisance[0] * trace.seen + nuisance[1])
        calibrated = self.columns(trace, others) @ nuisance
        return calibrated if trace.added is None else calibrated + trace.added

    def error(self, nuisance: np.ndarray) -> SmoothError | None:
        """The smooth error that fitted nuisances (m,) amount to; None where none is allowed."""
        if len(nuisance) < 3:
            return None
        weights = tuple(float(weight) for weight in nuisance[2:])
        return SmoothError(self.middle, self.half_range, weights, self.beside)


def nuisances_of(
    tolerance: ToleranceConfig, deviations: float, angle_low: float, angle_span: float
) -> Nuisances:
    """The nuisances that a configuration declares; no smooth error where `shape` is 0.

    deviations: that a tolerance of gain or offset is, IN_TOLERANCE or FORCE_IN_TOLERANCE.
    """
    half = max(0.5 * angle_span, 1e-9)
    usual = [max(t / deviations, 1e-9) for t in (tolerance.gain, tolerance.offset)]
    if tolerance.shape > 0.0:
        usual += SHAPES * [tolerance.shape]
    return Nuisances(angle_low + half, half, np.array(usual))


def absurd_gain(gain: float, tolerance: ToleranceConfig) -> bool:
    """Whether no calibration has such a gain: far off what was declared, and beyond ABSURD."""
    return not (abs(gain - 1.0) < FAR_OFF * tolerance.gain or 1.0 / ABSURD < gain < ABSURD)


def gain_between(simulated: np.ndarray, measured: np.ndarray) -> float:
    """The slope of a line of measured over simulated values (n,); 1 where none follows them."""
    spread = np.cov(simulated, measured)
    followed = spread[0, 1] ** 2 > FOLLOWS * spread[0, 0] * spread[1, 1]
    return float(spread[0, 1] / spread[0, 0]) if followed else 1.0


def with_smooth_error(
    nuisances: Nuisances, others: Mapping[str, np.ndarray], size: float
) -> Nuisances:
    """The same with a smooth error of about `size` over its own curve and each moving command."""
    beside = tuple(
        Beside(name, float(np.mean([values.min(), values.max()])), 0.5 * float(np.ptp(values)))
        for name, values in others.items()
        if np.ptp(values) > 0.0
    )
    count = SHAPES + (SHAPES + 1) * len(beside)
    deviations = np.concatenate([nuisances.deviations[:2], np.full(count, size)])
    return replace(nuisances, deviations=deviations, beside=beside)

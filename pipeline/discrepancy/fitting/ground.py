"""The ground of fits: a problem with its noise, its calibration and what parameters may be."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from pipeline.config import ToleranceConfig
from pipeline.discrepancy.fitting.calibration import (
    FAR_OFF,
    FORCE_IN_TOLERANCE,
    IN_TOLERANCE,
    Nuisances,
    absurd_gain,
    gain_between,
    nuisances_of,
)
from pipeline.discrepancy.noise.noise import NoiseModel, whitened
from pipeline.discrepancy.problem.problem import Problem
from pipeline.physics.mechanism import Trace
from pipeline.physics.motion import zero_of
from pipeline.physics.term import Parameter, Term

PRIOR_WIDTH = 10.0


@dataclass(frozen=True)
class Box:
    """The parameters of some terms with their bounds and weak Gaussian priors, (p,) each."""

    parameters: tuple[Parameter, ...]
    low: np.ndarray
    high: np.ndarray
    centre: np.ndarray
    precision: np.ndarray


@dataclass(frozen=True)
class Ground:
    """A problem with its noise: what every fit of it shares.

    used: (n,) rows that count. gains: the whitening filter of these rows.
    """

    problem: Problem
    noise: NoiseModel
    used: np.ndarray
    nuisances: Nuisances
    _boxes: dict[tuple[tuple[str, str], ...], Box] = field(default_factory=dict, repr=False)

    def box(self, *terms: Term) -> Box:
        """What the parameters of some terms may be here, in the terms' order."""
        key = tuple([(term.name, term.form) for term in terms])
        if key not in self._boxes:
            around = self.problem.around
            self._boxes[key] = box_of([p for term in terms for p in term.parameters(around)])
        return self._boxes[key]

    @property
    def precision(self) -> np.ndarray:
        """Of the priors of gain, offset and bends, (m, m)."""
        return self.nuisances.precision

    @cached_property
    def gains(self) -> np.ndarray:
        return self.noise.gains(self.problem.cycle, self.used, self.problem.motion.stands)

    @cached_property
    def kept(self) -> np.ndarray:
        return self.noise.kept(self.problem.motion.stands)

    @cached_property
    def log_scale(self) -> float:
        """Sum of the log deviations of the innovations."""
        return float(np.sum(np.log(self.gains[self.used, 3])))

    @cached_property
    def count(self) -> int:
        return int(self.used.sum())

    def whiten(self, columns: np.ndarray) -> np.ndarray:
        """Columns (n, m) as independent unit innovations on the used rows, (count, m)."""
        filled = np.ascontiguousarray(columns)
        return whitened(filled, *self.filter)

    @cached_property
    def filter(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Gains, what is kept from row to row, and cycles: see `whitened`."""
        return self.gains, self.kept, self.problem.cycle

    @cached_property
    def data(self) -> np.ndarray:
        """The whitened measurement, (count,)."""
        return self.whiten(np.where(self.used, self.problem.measured, 0.0)[:, None])[:, 0]

    def calibrating(self, trace: Trace) -> np.ndarray:
        """What the nuisances multiply in each row, (n, m)."""
        return self.nuisances.columns(trace, self.problem.motion.others)

    def answer(self, trace: Trace, nuisance: np.ndarray) -> np.ndarray:
        """What is measured in each row, (n,), by a trace and nuisances (m,)."""
        return self.nuisances.answer(trace, nuisance, self.problem.motion.others)

    def with_noise(self, noise: NoiseModel) -> "Ground":
        return replace(self, noise=noise)


def ground_of(problem: Problem, noise: NoiseModel, used: np.ndarray) -> Ground:
    """The ground of a problem's fits.

    Where the simulation's zero is off by more than FAR_OFF of what was declared, the declaration is
    refuted, and no term shall bend anything to spare the offset: it may be as large as it is. So
    may a gain that no calibration has. Of a force, which differs by direction where friction does,
    that refutes no zero that is declared to be trusted more than usual.
    """
    around, tolerance = problem.around, problem.tolerance
    deviations = IN_TOLERANCE if problem.derivatives is None else FORCE_IN_TOLERANCE
    off = abs(float(np.median((problem.measured - problem.simulated)[used])))
    trusted = problem.derivatives is not None and tolerance.offset < ToleranceConfig().offset
    if off > FAR_OFF * tolerance.offset and not trusted:
        tolerance = replace(tolerance, offset=deviations * off)
    gain = gain_between(problem.simulated[used], problem.measured[used])
    if problem.derivatives is None and absurd_gain(gain, tolerance):
        tolerance = replace(tolerance, gain=deviations * abs(gain - 1.0))
    nuisances = nuisances_of(tolerance, deviations, around.angle_low, around.angle_span)
    if problem.derivatives is None:
        simulated = problem.simulated[np.isfinite(problem.simulated)]
        nuisances = replace(nuisances, zero=zero_of(simulated))
    return Ground(problem, noise, used, nuisances)


def box_of(parameters: Sequence[Parameter]) -> Box:
    """Bounds and priors of some parameters."""
    widths = np.array([PRIOR_WIDTH * p.typical if p.typical > 0.0 else np.inf for p in parameters])
    return Box(
        tuple(parameters),
        np.array([p.low for p in parameters]),
        np.array([p.high for p in parameters]),
        np.array([prior_mean(p) for p in parameters]),
        1.0 / widths**2,
    )


def prior_mean(parameter: Parameter) -> float:
    """Zero for sizes (they may be nothing), the start for what has a usual value."""
    return 0.0 if parameter.low <= 0.0 <= parameter.high else parameter.start

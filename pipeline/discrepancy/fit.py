"""Fitting a set of terms: all parameters and nuisances together, under the whitened noise."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from pipeline.discrepancy.calibration import Nuisances, nuisances_of
from pipeline.discrepancy.noise import NoiseModel, whitened
from pipeline.discrepancy.problem import Problem
from pipeline.physics.mechanism import Mechanism, Piece, Trace
from pipeline.physics.term import Parameter, Term

ITERATIONS = 12
TOLERANCE = 0.02
PRIOR_WIDTH = 10.0


@dataclass(frozen=True)
class Ground:
    """A problem with its noise: what every fit of it shares.

    used: (n,) rows that count. gains: the whitening filter of these rows.
    """

    problem: Problem
    noise: NoiseModel
    used: np.ndarray
    nuisances: Nuisances

    @cached_property
    def gains(self) -> np.ndarray:
        return self.noise.gains(self.problem.cycle, self.used)

    @cached_property
    def log_scale(self) -> float:
        """Sum of the log deviations of the innovations."""
        return float(np.sum(np.log(self.gains[self.used, 3])))

    @property
    def count(self) -> int:
        return int(self.used.sum())

    def whiten(self, columns: np.ndarray) -> np.ndarray:
        """Columns (n, m) as independent unit innovations on the used rows, (count, m)."""
        filled = np.ascontiguousarray(columns)
        out = whitened(filled, self.gains, self.noise.correlation, self.problem.cycle)
        return out[self.used]

    @cached_property
    def data(self) -> np.ndarray:
        """The whitened measurement, (count,)."""
        return self.whiten(np.where(self.used, self.problem.measured, 0.0)[:, None])[:, 0]

    def with_noise(self, noise: NoiseModel) -> "Ground":
        return replace(self, noise=noise)


def ground_of(problem: Problem, noise: NoiseModel, used: np.ndarray) -> Ground:
    """The ground of a problem's fits."""
    around = problem.around
    return Ground(
        problem, noise, used, nuisances_of(problem.tolerance, around.angle_low, around.angle_span)
    )


@dataclass(frozen=True)
class Fit:
    """Terms with fitted values. cost: -2 log(likelihood x priors) without constants.

    nuisance: (m,) gain, offset, bends. trace: the mechanism's angles without calibration.
    """

    ground: Ground
    pieces: tuple[Piece, ...]
    nuisance: np.ndarray
    trace: Trace
    cost: float
    innovations: np.ndarray = field(repr=False, default_factory=lambda: np.zeros(0))

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(p.term.name for p in self.pieces)

    @property
    def predicted(self) -> np.ndarray:
        """The measurement that the fit expects in each row, (n,)."""
        return self.ground.nuisances.columns(self.trace) @ self.nuisance

    @property
    def free(self) -> int:
        """How many parameters its terms have."""
        return sum(len(p.values) for p in self.pieces)

    @cached_property
    def basis(self) -> np.ndarray:
        """Orthonormal columns of all that the fit can follow already, (count, m)."""
        own = [self.ground.whiten(self.ground.nuisances.columns(self.trace))]
        if self.pieces:
            own.append(jacobian(self))
        return np.linalg.qr(np.column_stack(own))[0]

    @cached_property
    def key(self) -> frozenset[tuple[str, str]]:
        return frozenset((p.term.name, p.term.form) for p in self.pieces)


def parameters_of(ground: Ground, term: Term) -> tuple[Parameter, ...]:
    return term.parameters(ground.problem.around)


def respond(ground: Ground, pieces: Sequence[Piece]) -> Trace:
    """The mechanism's angles over all rows, without calibration."""
    return Mechanism(ground.problem.curve, pieces).trace(ground.problem.motion)


def evaluate(ground: Ground, pieces: Sequence[Piece]) -> Fit:
    """The fit with these values; gain, offset and bends by linear least squares."""
    trace = respond(ground, pieces)
    columns = ground.whiten(ground.nuisances.columns(trace))
    weights = 1.0 / ground.nuisances.deviations
    normal = columns.T @ columns + np.diag(weights**2)
    expected = ground.nuisances.expected
    nuisance = np.linalg.solve(normal, columns.T @ ground.data + weights**2 * expected)
    innovations = ground.data - columns @ nuisance
    cost = float(innovations @ innovations + np.sum(((nuisance - expected) * weights) ** 2))
    cost += 2.0 * ground.log_scale + prior_cost(ground, pieces)
    return Fit(ground, tuple(pieces), nuisance, trace, cost, innovations)


def prior_cost(ground: Ground, pieces: Sequence[Piece]) -> float:
    """-2 log of the weak priors that keep parameters at usual sizes."""
    total = 0.0
    for piece in pieces:
        for p, value in zip(parameters_of(ground, piece.term), piece.values, strict=True):
            if p.typical > 0.0:
                total += ((value - prior_mean(p)) / (PRIOR_WIDTH * p.typical)) ** 2
    return total


def prior_mean(parameter: Parameter) -> float:
    """Zero for sizes (they may be nothing), the start for what has a usual value."""
    return 0.0 if parameter.low <= 0.0 <= parameter.high else parameter.start


def jacobian(fit: Fit) -> np.ndarray:
    """Whitened derivatives of the prediction by every term parameter, (count, free).

    A parameter that does not move the prediction (a moment between two samples) gives zeros.
    """
    ground = fit.ground
    predicted = fit.predicted
    columns = np.zeros((len(fit.trace.seen), fit.free))
    steps = np.ones(fit.free)
    k = 0
    for i, piece in enumerate(fit.pieces):
        for j, p in enumerate(parameters_of(ground, piece.term)):
            steps[k] = difference_step(p, piece.values[j])
            if steps[k] != 0.0:
                values = piece.values.copy()
                values[j] += steps[k]
                pieces = (*fit.pieces[:i], Piece(piece.term, values), *fit.pieces[i + 1 :])
                moved = ground.nuisances.columns(respond(ground, pieces)) @ fit.nuisance
                columns[:, k] = (moved - predicted) / steps[k]
            k += 1
    return ground.whiten(columns)


def difference_step(p: Parameter, value: float) -> float:
    """A step that stays within bounds; 0 for a parameter that has no width."""
    size = 0.01 * p.typical if p.typical > 0.0 else 1e-4 * (p.high - p.low)
    if p.stepwise:
        return 0.0
    return -size if value + size > p.high else size


def improve(fit: Fit, iterations: int = ITERATIONS) -> Fit:
    """Levenberg-Marquardt from a fit, within the bounds, until the cost stands still."""
    if not fit.pieces:
        return fit
    ground = fit.ground
    bounds = [p for piece in fit.pieces for p in parameters_of(ground, piece.term)]
    low, high = np.array([p.low for p in bounds]), np.array([p.high for p in bounds])
    precision = np.array(
        [1.0 / (PRIOR_WIDTH * p.typical) ** 2 if p.typical > 0.0 else 0.0 for p in bounds]
    )
    centre = np.array([prior_mean(p) for p in bounds])
    damping = 1e-2
    for _ in range(iterations):
        values = np.concatenate([p.values for p in fit.pieces])
        slopes = _beside_nuisances(fit, jacobian(fit))
        gradient = slopes.T @ fit.innovations - precision * (values - centre)
        normal = slopes.T @ slopes + np.diag(precision)
        stuck = ((values <= low) & (gradient < 0.0)) | ((values >= high) & (gradient > 0.0))
        stuck |= np.diag(normal) <= 1e-12
        step = np.zeros(len(values))
        better = None
        for _ in range(6):
            free = ~stuck
            if not free.any():
                return fit
            a = normal[np.ix_(free, free)]
            step[free] = np.linalg.solve(a + damping * np.diag(np.diag(a)), gradient[free])
            trial = evaluate(ground, _with_values(fit.pieces, np.clip(values + step, low, high)))
            if trial.cost < fit.cost:
                better = trial
                break
            damping *= 8.0
        if better is None:
            return fit
        gained = fit.cost - better.cost
        fit, damping = better, damping / 6.0
        if gained < TOLERANCE:
            break
    return fit


def _beside_nuisances(fit: Fit, slopes: np.ndarray) -> np.ndarray:
    """Slopes less what gain, offset and bends take over of them."""
    ground = fit.ground
    columns = ground.whiten(ground.nuisances.columns(fit.trace))
    weights = 1.0 / ground.nuisances.deviations
    stacked = columns.T @ columns + np.diag(weights**2)
    return slopes - columns @ np.linalg.solve(stacked, columns.T @ slopes)


def _with_values(pieces: Sequence[Piece], values: np.ndarray) -> tuple[Piece, ...]:
    out, k = [], 0
    for piece in pieces:
        out.append(Piece(piece.term, values[k : k + len(piece.values)]))
        k += len(piece.values)
    return tuple(out)

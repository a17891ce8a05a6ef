"""Fitting a set of terms: all parameters and nuisances together, under the whitened noise."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from scipy.linalg import orth

from pipeline.discrepancy.fitting.ground import Box, Ground
from pipeline.discrepancy.fitting.normal import added, regressed, solved, stepped
from pipeline.physics.mechanism import Mechanism, Trace
from pipeline.physics.piece import Piece
from pipeline.physics.term import Parameter, Term

ITERATIONS = 12
DAMPINGS = 6
TOLERANCE = 0.1
TRUSTED = 0.25
BEHIND = 200.0
FIRST_DAMPING = 1e-2
SHARE_OF_VALUE = 0.02
DEPENDENT = 1e-7
FITTED = 2.0  # -2 log odds that a simulation's gain was fitted to its robot


@dataclass(frozen=True)
class Fit:
    """Terms with fitted values. cost: -2 log(likelihood x priors) without constants.

    nuisance: (m,) gain, offset, bends; expected: their prior means. trace: the mechanism's angles
    without calibration. calibrating: (count, m) whitened, what the nuisances multiply.
    """

    ground: Ground
    pieces: tuple[Piece, ...]
    nuisance: np.ndarray
    expected: np.ndarray
    trace: Trace
    cost: float
    innovations: np.ndarray = field(repr=False)
    calibrating: np.ndarray = field(repr=False)

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(p.term.name for p in self.pieces)

    def without(self, *gone: Piece) -> tuple[Piece, ...]:
        """Its pieces but for some of them."""
        return tuple(p for p in self.pieces if not any(p is g for g in gone))

    def but_for(self, name: str) -> tuple[Piece, ...]:
        """Its pieces but those of a name; what is only kept under it goes where it is all there is.

        A snap beside friction has no name of its own (`Term.nameless`).
        """
        own = [p for p in self.pieces if p.term.name == name]
        return self.without(*([p for p in own if not p.term.nameless] or own))

    @property
    def slow(self) -> frozenset[str]:
        """The names of its terms that move the zero."""
        return frozenset(p.term.name for p in self.pieces if p.term.slow)

    @cached_property
    def predicted(self) -> np.ndarray:
        """The measurement that the fit expects in each row, (n,)."""
        return self.ground.answer(self.trace, self.nuisance)

    @property
    def mean_square(self) -> float:
        """Of what it leaves of the rows used [measurement's unit, squared]."""
        left = self.ground.problem.measured - self.predicted
        return float(np.mean(left[self.ground.used] ** 2))

    @property
    def free(self) -> int:
        """How many parameters its terms have."""
        return len(self.values)

    @property
    def box(self) -> Box:
        """What its terms' parameters may be."""
        return self.ground.box(*[p.term for p in self.pieces])

    @cached_property
    def values(self) -> np.ndarray:
        """Of all its terms' parameters, (free,)."""
        return values_of(self.pieces)

    @cached_property
    def basis(self) -> np.ndarray:
        """Orthonormal columns of all that the fit can follow already, (count, m)."""
        return spanned(np.column_stack([self.calibrating, self.slopes]))

    @cached_property
    def takes_over(self) -> tuple[np.ndarray, np.ndarray]:
        """What the fit can follow already, as far as a declared tolerance of its curve lets it.

        (count, m) parts in the rows of orthonormal columns that go on through the prior of gain,
        offset and bends, and (m,) what the residual, and how far they are off, has along each.
        """
        if self.ground.nuisances.straight:
            return self.basis, self.innovations @ self.basis
        held, count = self.ground.nuisances.held, len(self.innovations)
        prior = np.hstack([held, np.zeros((len(held), self.free))])
        columns = np.vstack([np.hstack([self.calibrating, self.slopes]), prior])
        basis = spanned(columns)
        off = held @ (self.expected - self.nuisance)
        return basis[:count], self.innovations @ basis[:count] + off @ basis[count:]

    @cached_property
    def changes(self) -> np.ndarray:
        """Derivatives of the prediction by gain, offset, bends and every term parameter, (n, m)."""
        return np.hstack([self.ground.calibrating(self.trace), self.by_parameter])

    @cached_property
    def by_parameter(self) -> np.ndarray:
        """Derivatives of the prediction by every term parameter, (n, free)."""
        return jacobian(self)

    @cached_property
    def slopes(self) -> np.ndarray:
        """The same, whitened, (count, free)."""
        return self.ground.whiten(self.by_parameter)

    @cached_property
    def key(self) -> frozenset[tuple[str, str]]:
        return frozenset((p.term.name, p.term.form) for p in self.pieces)


def spanned(columns: np.ndarray) -> np.ndarray:
    """Orthonormal columns (n, k) of all that some columns (n, m) of any lengths span.

    A direction in which they differ by DEPENDENT of their length or less is rounding, and chance.
    """
    lengths = np.sqrt(np.sum(columns * columns, axis=0))
    return np.asarray(orth(columns / np.where(lengths > 0.0, lengths, 1.0), DEPENDENT))


def parameters_of(ground: Ground, term: Term) -> tuple[Parameter, ...]:
    """A term's parameters as these data bound and start them."""
    return ground.box(term).parameters


def respond(ground: Ground, pieces: Sequence[Piece]) -> Trace:
    """The mechanism's angles over all rows, without calibration."""
    return ground.problem.trace(pieces)


def respond_beside(fit: Fit, pieces: Sequence[Piece], *changed: Term) -> Trace:
    """The angles of pieces that differ from a fit's in some terms only, new ones or old."""
    problem = fit.ground.problem
    if any(term.before_curve for term in changed) or not problem.by_row(pieces):
        return problem.trace(pieces)
    mechanism, known = Mechanism(problem.curve, pieces, course=problem.course), fit.trace
    if any(term.in_balance for term in changed):
        return mechanism.balanced(known.asked, problem.motion)
    return mechanism.sensed(known.asked, known.body, problem.motion)


def evaluate(ground: Ground, pieces: Sequence[Piece]) -> Fit:
    """The fit with these values; gain, offset and bends by linear least squares."""
    return calibrated(ground, pieces, respond(ground, pieces))


def calibrated(ground: Ground, pieces: Sequence[Piece], trace: Trace) -> Fit:
    """The fit with pieces whose angles are known."""
    data = ground.data
    if trace.added is not None:
        data = data - ground.whiten(trace.added[:, None])[:, 0]
    raw, expected = ground.calibrating(trace), expected_of(ground, pieces)
    found = regressed(raw, data, ground.filter, ground.precision, expected)
    if any(piece.term.lowers_gain for piece in pieces):
        fitted = np.array([gain_of_fitted(ground, trace), *expected[1:]])
        other = regressed(raw, data, ground.filter, ground.precision, fitted)
        if other[3] + FITTED < found[3]:
            found, expected = (*other[:3], other[3] + FITTED), fitted
    nuisance, innovations, columns, cost = found
    cost += 2.0 * ground.log_scale + prior_cost(ground, pieces)
    return Fit(ground, tuple(pieces), nuisance, expected, trace, cost, innovations, columns)


def gain_of_fitted(ground: Ground, trace: Trace) -> float:
    """The gain beside what gives way, of a simulation that was fitted to the robot without it.

    On average over the rows used, such a simulation asks for no more than the robot moves.
    """
    asked, seen = trace.asked[ground.used], trace.seen[ground.used]
    asked = asked - np.mean(asked)
    return float(asked @ asked) / max(float(asked @ seen), 1e-300)


def expected_of(ground: Ground, pieces: Sequence[Piece]) -> np.ndarray:
    """Prior means of gain, offset and bends, (m,): the offset is about a zero on average.

    Where what gives way lowers the gain, that may be another: see `gain_of_fitted`.
    """
    expected = ground.nuisances.expected.copy()
    expected[1] -= drifted(ground, pieces)
    return expected


def drifted(ground: Ground, pieces: Sequence[Piece]) -> float:
    """How far a force's zero is moved on average [measurement's unit]; 0.0 of an angle's.

    Where a force's zero began, or comes to at last, may be many tolerances from there.
    """
    motion, mean = ground.problem.motion, 0.0
    if motion.kinetics is None:
        return mean
    for piece in pieces:
        if piece.term.slow:
            moved = piece.term.respond(np.zeros(len(motion)), motion, piece.values, None)[0]
            mean += float(np.mean(moved[ground.used]))
    return mean


def prior_cost(ground: Ground, pieces: Sequence[Piece]) -> float:
    """-2 log of the weak priors that keep parameters at usual sizes."""
    if not pieces:
        return 0.0
    box = ground.box(*[p.term for p in pieces])
    off = values_of(pieces) - box.centre
    return float(box.precision @ (off * off))


def values_of(pieces: Sequence[Piece]) -> np.ndarray:
    """The parameters of some pieces, in their order."""
    return np.concatenate([p.values for p in pieces]) if pieces else np.zeros(0)


def jacobian(fit: Fit, known: Sequence[Piece] = ()) -> np.ndarray:
    """Derivatives of the prediction by every parameter but those of pieces known, (n, free).

    A parameter that does not move the prediction (a moment between two samples) gives zeros. Fits
    of the same values under other noise share the traces behind it.
    """
    ground, beside = fit.ground, fit.trace.beside
    columns, k, row = np.zeros((fit.free, len(fit.trace.seen))), 0, 0
    for i, piece in enumerate(fit.pieces):
        if any(piece is other for other in known):
            k += len(piece.values)
            continue
        for j, p in enumerate(parameters_of(ground, piece.term)):
            step = difference_step(p, piece.values[j])
            if step != 0.0:
                if k not in beside:
                    values = piece.values.copy()
                    values[j] += step
                    pieces = (*fit.pieces[:i], Piece(piece.term, values), *fit.pieces[i + 1 :])
                    beside[k] = respond_beside(fit, pieces, piece.term)
                moved_by(fit, beside[k], 1.0 / step, columns[row])
            k, row = k + 1, row + 1
    return columns[:row].T


def slopes_beside(fit: Fit, begun: Fit) -> np.ndarray:
    """Whitened slopes (count, free) of a fit, those of pieces that `begun` has, too, from there."""
    new = fit.without(*begun.pieces)
    found = by_piece(begun.slopes, begun.pieces)
    found |= by_piece(fit.ground.whiten(jacobian(fit, begun.pieces)), new)
    return np.hstack([found[id(piece)] for piece in fit.pieces])


def by_piece(columns: np.ndarray, pieces: Sequence[Piece]) -> dict[int, np.ndarray]:
    """Columns (count, free), one for each parameter of some pieces, parted by these."""
    ends = np.cumsum([len(piece.values) for piece in pieces])
    return {id(p): part for p, part in zip(pieces, np.hsplit(columns, ends), strict=False)}


def moved_by(fit: Fit, moved: Trace, factor: float, out: np.ndarray) -> None:
    """How far a trace moves a fit's prediction, times a factor (into `out`, (n,))."""
    ground = fit.ground
    if ground.nuisances.straight and moved.added is None:
        np.subtract(moved.seen, fit.trace.seen, out=out)
        factor *= fit.nuisance[0]
    else:
        np.subtract(ground.answer(moved, fit.nuisance), fit.predicted, out=out)
    out *= factor


def difference_step(p: Parameter, value: float) -> float:
    """A step that stays within bounds; 0 for a parameter that has no width."""
    size = 0.01 * p.typical if p.typical > 0.0 else 1e-4 * (p.high - p.low)
    if p.relative:
        size = SHARE_OF_VALUE * value
    if p.moment:
        return 0.0
    return -size if value + size > p.high else size


def improve(fit: Fit, iterations: int = ITERATIONS, begun: Fit | None = None) -> Fit:
    """Levenberg-Marquardt from a fit, within the bounds, until a step promises nothing.

    As long as a step gains about what its slopes foretold, they are corrected by what it did
    (Broyden, Math. Comp. 19 (1965) 577), in place of differences for every parameter. begun: a fit
    with some of the same pieces, whose slopes there serve for a first step; where this one is
    BEHIND it, terms move each other far. What is begun so is a trial: that corrected slopes promise
    nothing is not made sure of; but of a force, whose forms differ by less.
    """
    if not fit.pieces:
        return fit
    box, damping, slopes = fit.box, FIRST_DAMPING, None
    if begun is not None and fit.cost < begun.cost + BEHIND:
        slopes = _beside_nuisances(fit, slopes_beside(fit, begun))
    for _ in range(iterations):
        known = slopes is None
        slopes = _beside_nuisances(fit, fit.slopes) if slopes is None else slopes
        normal, gradient = _equations(fit, slopes, fit.innovations)
        better, foretold, damping = _stepped(fit, box, normal, gradient, damping)
        if better is None:
            if known or (begun is not None and fit.ground.problem.derivatives is None):
                return fit
            slopes, damping = None, FIRST_DAMPING
            continue
        gained = fit.cost - better.cost
        if known and gained < TOLERANCE:
            return better
        trusted = gained > TRUSTED * foretold
        slopes = _corrected(slopes, fit, better, normal.diagonal()) if trusted else None
        fit, damping = better, damping / 6.0
    return fit


def followed(fit: Fit, trial: Fit) -> list[Fit]:
    """A trial that has one more term than a fit, the fit's own terms one step on beside that."""
    if not fit.pieces:
        return []
    box, slopes = fit.box, _beside_nuisances(fit, fit.slopes)
    normal, gradient = _equations(fit, slopes, trial.innovations)
    values, foretold = stepped(fit.values, normal, gradient, box.low, box.high, FIRST_DAMPING)
    if foretold < TOLERANCE:
        return []
    return [evaluate(fit.ground, (*_with_values(fit.pieces, values), *trial.pieces[-1:]))]


def _equations(
    fit: Fit, slopes: np.ndarray, innovations: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Normal matrix and half the cost's fall by each parameter, (free, free) and (free,)."""
    box = fit.box
    gradient = slopes.T @ innovations - box.precision * (fit.values - box.centre)
    normal = slopes.T @ slopes
    normal.flat[:: fit.free + 1] += box.precision
    return normal, gradient


def _stepped(
    fit: Fit, box: Box, normal: np.ndarray, gradient: np.ndarray, damping: float
) -> tuple[Fit | None, float, float]:
    """A better fit one step on, damped as much as that takes; None if no step promises one.

    With the gain that the step's slopes foretold, and the damping.
    """
    for _ in range(DAMPINGS):
        moved, foretold = stepped(fit.values, normal, gradient, box.low, box.high, damping)
        if foretold < TOLERANCE:
            break
        trial = evaluate(fit.ground, _with_values(fit.pieces, moved))
        if trial.cost < fit.cost:
            return trial, foretold, damping
        damping *= 8.0
    return None, 0.0, damping


def _corrected(slopes: np.ndarray, fit: Fit, better: Fit, squares: np.ndarray) -> np.ndarray:
    """Slopes (count, free) that explain all that a step did; squares: (free,) of their lengths."""
    step = better.values - fit.values
    along = squares * step
    length = float(along @ step)
    if length <= 0.0:
        return slopes
    missed = fit.innovations - better.innovations - slopes @ step
    return added(slopes, missed, along / length)


def _beside_nuisances(fit: Fit, slopes: np.ndarray) -> np.ndarray:
    """Slopes (count, free) less what gain, offset and bends take over of them."""
    columns = fit.calibrating
    normal = columns.T @ columns + fit.ground.precision
    return np.asarray(slopes - columns @ solved(normal, columns.T @ slopes))


def _with_values(pieces: Sequence[Piece], values: np.ndarray) -> tuple[Piece, ...]:
    out, k = [], 0
    for piece in pieces:
        out.append(Piece(piece.term, values[k : k + len(piece.values)]))
        k += len(piece.values)
    return tuple(out)

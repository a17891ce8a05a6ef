"""What a choice's names are in disguise: each term says what it hides, the fit how surely."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pipeline.discrepancy.fitting.charge import independent
from pipeline.discrepancy.fitting.fit import Fit, evaluate, improve, parameters_of
from pipeline.discrepancy.fitting.reform import reformed
from pipeline.discrepancy.model.intervals import covariance_of
from pipeline.discrepancy.search.elsewhere import differing
from pipeline.discrepancy.search.weighing import LEAST_GAIN, RIVAL_GAP, TIE, Choice, Search, names
from pipeline.physics.piece import Piece
from pipeline.physics.term import Term
from pipeline.recording import reversals_of

SURE = 2.0
SMALL = 0.25


@dataclass(frozen=True)
class Seen:
    """What a fit shows of the parameters of the piece at a place (see `Term.plainer`)."""

    fit: Fit
    place: int

    @property
    def step(self) -> float:
        term = self.fit.pieces[self.place].term
        return where_acting(self.fit.ground.problem.around.step, self.fit, term)

    def worth(self, size: int, course: Sequence[int] = ()) -> bool:
        least = (1 + len(course)) * np.log(independent(self.fit.ground))
        squared = self.fit.pieces[self.place].values[size] ** 2
        return bool(squared > least * self.variance(size, course))

    def most(self, size: int, course: Sequence[int] = ()) -> float:
        value = self.fit.pieces[self.place].values[size]
        return float(value + SURE * np.sqrt(self.variance(size, course)))

    def variance(self, size: int, course: Sequence[int]) -> float:
        """Variance of a parameter, its course known."""
        fit = self.fit
        first = len(fit.nuisance) + sum(len(p.values) for p in fit.pieces[: self.place])
        return variance_given(covariance_of(fit), first + size, first + np.array(course, dtype=int))

    def sharp(self, reach: int) -> bool:
        """Whether corners are sharper than a step, that of `first_step`.

        Or sharper than two, of which one sample sees the inside, where they may be as sharp as can
        be. But turns with finer steps may show that corners within a step are rounded.
        """
        fit, place = self.fit, self.place
        piece = fit.pieces[place]
        step = where_acting(first_step(fit.ground.problem.motion.drive), fit, piece.term)
        parameters = parameters_of(fit.ground, piece.term)

        def costs(other: float) -> float:
            values = piece.values.copy()
            values[reach] = other
            pieces = (*fit.pieces[:place], Piece(piece.term, values), *fit.pieces[place + 1 :])
            return evaluate(fit.ground, pieces).cost - fit.cost

        if 2.0 * step <= piece.values[reach] or costs(2.0 * step) <= SURE**2:
            return False
        within = step > piece.values[reach] and costs(step) > SURE**2
        return costs(parameters[reach].low) <= (TIE if within else SURE**2)


def plain(choice: Choice) -> frozenset[str]:
    """The names of a choice, each that is another one in disguise under that other name."""
    return frozenset(plainly(choice.fit))


def plainly(fit: Fit) -> list[str]:
    """The same of each piece of a fit."""
    return [p.term.plainer(p.values, Seen(fit, k)) for k, p in enumerate(fit.pieces)]


def as_itself(choice: Choice, best: Choice) -> bool:
    """Whether a choice is no other one in disguise, nor as far as can be towards the best one."""
    return plain(choice) == names(choice) and not limits(choice) & names(best)


def may_stand_for(choice: Choice, best: Choice) -> bool:
    """Whether a choice is the best one in disguise, but what it has for that may be itself."""
    return plain(choice) == names(best) and names(choice) - names(best) <= maybe_themselves(choice)


def maybe_themselves(choice: Choice) -> frozenset[str]:
    """Names of a choice that may be themselves though in disguise (`Term.may_be_itself`)."""
    fit = choice.fit
    around = fit.ground.problem.around
    shown = [(p, Seen(fit, k)) for k, p in enumerate(fit.pieces)]
    return frozenset(
        p.term.name for p, seen in shown if p.term.may_be_itself(p.values, around, seen)
    )


def limits(choice: Choice) -> frozenset[str]:
    """What terms of a choice come to that can go no further towards it (`Term.limit`)."""
    around = choice.fit.ground.problem.around
    return frozenset(p.term.limit(p.values, around) for p in choice.fit.pieces)


def undisguised(choices: Sequence[Choice]) -> Choice:
    """The best of some choices, or where that is in disguise, the best of what it is.

    Or of its own names in other forms, which are not: each of two names may hide the other.
    """
    best = choices[0]
    wanted = plain(best)
    near = [c for c in choices if c.score < best.score + RIVAL_GAP]
    same = [c for c in near if names(c) == wanted]
    if wanted != names(best):
        both = [c for c in near if names(c) in (wanted, names(best))]
        same = [c for c in both if plain(c) == names(c)] or same
    return min(same, key=lambda c: c.score, default=best)


def variance_given(covariance: np.ndarray, at: int, known: np.ndarray) -> float:
    """Variance of one parameter (m, m) where others (their places) are known, of a Gaussian."""
    deviations = np.sqrt(np.maximum(np.diag(covariance), 1e-300))
    correlation = covariance / np.outer(deviations, deviations)
    along = correlation[at, known]
    told = along @ np.linalg.pinv(correlation[np.ix_(known, known)], hermitian=True) @ along
    return float(covariance[at, at] * max(1.0 - told, 0.0))


def first_step(drive: np.ndarray) -> float:
    """A step that a quarter of the turns of a drive (n,) begin with no more than; 0 without any.

    Where it goes round a bend slowly, or by steps of any size, it shows more of a corner than its
    usual step would.
    """
    steps = np.abs(np.diff(drive))
    moves = np.flatnonzero(steps)
    turns = reversals_of(drive)
    first = np.searchsorted(moves, turns)
    first = first[first < len(moves)]
    return float(np.quantile(steps[moves[first]], SMALL)) if len(first) else 0.0


def where_acting(step: float, fit: Fit, term: Term) -> float:
    """A step of the drive where a term acts, before the nominal curve or behind it."""
    around = fit.ground.problem.around
    slope = around.angle_span / max(around.drive_span, 1e-300)
    return step if term.before_curve else step * slope


def with_plain(search: Search, choices: list[Choice]) -> list[Choice]:
    """The choices, the best also as what it is in disguise, where no search came by that.

    Nor does one that came by the same names with much worse sizes.
    """
    best = choices[0]
    wanted = plain(best)
    if any(names(c) == wanted and c.score < best.score + LEAST_GAIN for c in choices):
        return choices
    choice = search.weighed(plain_fit(search, best.fit), best.place)
    near = names(choice) == wanted and choice.score < best.score + RIVAL_GAP
    return [*choices, choice] if near else choices


def plain_fit(search: Search, fit: Fit) -> Fit:
    """A fit with each piece that is another one in disguise as that other, begun from its sizes."""
    shown, spare = plainly(fit), []
    for k, name in enumerate(shown):
        if name == fit.pieces[k].term.name:
            continue
        forms = differing((t for t in search.terms if t.name == name), fit)
        if forms and shown.count(name) == 1:
            fit = min((reformed(fit, k, form) for form in forms), key=lambda f: f.cost)
        else:
            spare.append(k)
    kept = [p for k, p in enumerate(fit.pieces) if k not in spare]
    return improve(evaluate(fit.ground, kept)) if spare else fit

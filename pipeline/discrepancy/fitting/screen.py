"""Screening: how much each term could gain beside a fit, by one linear step."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pipeline.discrepancy.fitting.fit import (
    Fit,
    calibrated,
    followed,
    moved_by,
    parameters_of,
    respond_beside,
)
from pipeline.discrepancy.fitting.moments import moments
from pipeline.discrepancy.noise.serial import orthonormal, without
from pipeline.discrepancy.problem.problem import Problem
from pipeline.physics.mechanism import Piece
from pipeline.physics.term import Term
from pipeline.recording import branch_of

SCALES = (0.01, 8.0)
PROMISING = 4
PERIOD = 1
SURPRISING = 3


@dataclass(frozen=True)
class Lead:
    """A term with values worth fitting, and the fall of the cost that a linear step promises."""

    term: Term
    values: np.ndarray
    gain: float


@dataclass(frozen=True)
class Effects:
    """What every candidate of every term does to the nominal mechanism.

    places: term and values of each candidate. columns: (n, k) change of the seen angle. sized: (k,)
    whether each has a size to scale.
    """

    places: Sequence[tuple[Term, np.ndarray]]
    columns: np.ndarray
    sized: np.ndarray

    def promising(
        self, fit: Fit, terms: Sequence[Term], most: int
    ) -> list[tuple[Term, np.ndarray]]:
        """The candidates of each term whose nominal effect suits a fit's residual best.

        Where the fit answers late, nominal effects have the wrong phase on either way: of what has
        one, those are kept whose period suits best in any phase.
        """
        allowed = {(t.name, t.form) for t in terms}
        wanted = [k for k, (t, _) in enumerate(self.places) if (t.name, t.form) in allowed]
        if not wanted:
            return []
        first = wanted[0]
        span = slice(first, wanted[-1] + 1)
        gains = gains_of(fit, self.sized[span], self.columns[:, span], float(fit.nuisance[0]))[0]
        gains = gains[np.array(wanted) - first]
        own: dict[tuple[str, str], list[tuple[float, int]]] = {}
        for k, gain in zip(wanted, gains, strict=True):
            term = self.places[k][0]
            own.setdefault((term.name, term.form), []).append((-gain, k))
        out = []
        for few in own.values():
            ranked = [k for _, k in sorted(few)[:most]]
            if self.places[ranked[0]][0].periodic and late(fit):
                ranked = self.in_any_phase(fit, [k for _, k in few], most)
            out += [self.places[k] for k in ranked]
        return out

    def in_any_phase(self, fit: Fit, wanted: Sequence[int], most: int) -> list[int]:
        """Of some candidates of one term those of the `most` periods that gain most, each way.

        A late answer to a wave is that wave in another phase on either way of the drive.
        """
        periods = {k: float(self.places[k][1][PERIOD]) for k in wanted}
        alike = [[k for k in wanted if periods[k] == p] for p in dict.fromkeys(periods.values())]
        up = branch_of(fit.ground.problem.motion.drive)[:, None] > 0
        columns = self.columns[:, [k for few in alike for k in few[::2]]]
        both = fit.ground.whiten(
            np.stack([columns * up, columns * ~up], axis=2).reshape(len(up), -1)
        )
        both = without(both, fit.basis)
        gains, end = [], 0
        for few in alike:
            begin, end = end, end + 2 * len(few[::2])
            along = fit.innovations @ orthonormal(both[:, begin:end])
            gains.append(float(along @ along))
        return [k for g in np.argsort(gains)[::-1][:most] for k in alike[g]]


def effects_of(problem: Problem, terms: Sequence[Term]) -> Effects:
    """The nominal effects of all candidates of some terms."""
    nominal = problem.trace(()).seen
    places = [(t, v) for t in terms for v in t.candidates(problem.motion, problem.around)]
    columns = np.empty((len(nominal), len(places)))
    for k, (term, values) in enumerate(places):
        columns[:, k] = problem.trace((Piece(term, values),)).seen - nominal
    return Effects(places, columns, sized_of(places))


def late(fit: Fit) -> list[Piece]:
    """The pieces behind which its answer comes late on either way."""
    return [p for p in fit.pieces if p.term.remembers and not p.term.adds]


def screen(
    fit: Fit, effects: Effects, terms: Sequence[Term], starts: int = 3, quick: bool = False
) -> list[Lead]:
    """The `starts` best candidates of each term beside a fit, best first.

    None that could only gain by a size that its bounds don't allow, unless that is to be quick.
    """
    places = effects.promising(fit, terms, PROMISING) + sudden(fit, terms)
    if not places:
        return []
    columns = np.empty((len(places), len(fit.trace.seen)))
    for k, (term, values) in enumerate(places):
        trace = respond_beside(fit, (*fit.pieces, Piece(term, values)), term)
        moved_by(fit, trace, 1.0, columns[k])
    best: dict[tuple[str, str], list[Lead]] = {}
    gains, factors = gains_of(fit, sized_of(places), columns.T)
    for (term, values), gain, factor in zip(places, gains, factors, strict=True):
        scaled = clipped(fit, term, term.scaled(values, factor))
        if gain > 0.0 and (quick or not term.void(scaled)):
            best.setdefault((term.name, term.form), []).append(Lead(term, scaled, gain))
    leads = [lead for few in best.values() for lead in sorted(few, key=lambda x: -x.gain)[:starts]]
    return sorted(leads, key=lambda lead: -lead.gain)


def sudden(fit: Fit, terms: Sequence[Term]) -> list[tuple[Term, np.ndarray]]:
    """Candidates of terms that act at a moment, at the samples that surprise a fit most.

    In noise that is strongly correlated a jump surprises at its own sample and nowhere else, so
    that no grid of moments meets it.
    """
    before = np.argsort(np.abs(fit.innovations[1:]))[::-1][:SURPRISING]
    moments_s = moments(fit)[before]
    return [(t, v) for t in terms for v in t.at_moments(moments_s, fit.ground.problem.around)]


def gains_of(
    fit: Fit, sized: np.ndarray, columns: np.ndarray, scale: float = 1.0
) -> tuple[np.ndarray, np.ndarray]:
    """Fall of the cost by one step along each column (n, k) times scale, and that step's factor.

    The factor is the step's coefficient as far as a term can follow it, 1 where it has no size.
    """
    ground = fit.ground
    d = ground.whiten(columns)
    basis = fit.basis
    taken = basis.T @ d
    size = scale**2 * (np.einsum("ij,ij->j", d, d) - np.einsum("ij,ij->j", taken, taken))
    along = scale * (fit.innovations @ d - (fit.innovations @ basis) @ taken)
    moves = size > 1e-9
    coefficient = along / np.where(moves, size, 1.0)
    followed = np.where(coefficient > 0.0, 1.0, -1.0) * np.clip(np.abs(coefficient), *SCALES)
    factor = np.where(sized & moves, followed, 1.0)
    return np.where(moves, 2.0 * factor * along - factor**2 * size, 0.0), factor


def sized_of(places: Sequence[tuple[Term, np.ndarray]]) -> np.ndarray:
    """Whether each term with its values has a size to scale, a mask."""
    same = [np.array_equal(term.scaled(values, 2.0), values) for term, values in places]
    return ~np.array(same, dtype=bool)


def clipped(fit: Fit, term: Term, values: np.ndarray) -> np.ndarray:
    """Values within the term's bounds."""
    parameters = parameters_of(fit.ground, term)
    return np.clip(values, [p.low for p in parameters], [p.high for p in parameters])


def started(fit: Fit, leads: Sequence[Lead], room: bool = False) -> Fit:
    """The fit with the best of some leads of one term added, not yet improved.

    room: each is begun beside the others as they would then be, too. What a lead promises holds for
    terms that make room for it: what bends much where others bend already may be taken back to
    nothing before they have moved.
    """
    trials = []
    for lead in leads:
        pieces = (*fit.pieces, Piece(lead.term, lead.values))
        trial = calibrated(fit.ground, pieces, respond_beside(fit, pieces, lead.term))
        trials += [trial, *followed(fit, trial)] if room else [trial]
    return min(trials, key=lambda trial: trial.cost)

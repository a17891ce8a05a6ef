"""Screening: how much each term could gain beside a fit, by one linear step."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pipeline.discrepancy.fit import Fit, calibrated, parameters_of, respond_beside
from pipeline.discrepancy.problem import Problem
from pipeline.physics.mechanism import Piece
from pipeline.physics.term import Term

SCALES = (0.1, 8.0)
PROMISING = 4
LATE = ("frame_lag", "response_lag", "backlash", "tension_loss", "friction", "creep")
PHASED = ("transmission_ripple",)


@dataclass(frozen=True)
class Lead:
    """A term with values worth fitting, and the fall of the cost that a linear step promises."""

    term: Term
    values: np.ndarray
    gain: float


@dataclass(frozen=True)
class Effects:
    """What every candidate of every term does to the nominal mechanism.

    places: term and values of each candidate. columns: (n, k) change of the seen angle.
    """

    places: Sequence[tuple[Term, np.ndarray]]
    columns: np.ndarray

    def promising(
        self, fit: Fit, terms: Sequence[Term], most: int
    ) -> list[tuple[Term, np.ndarray]]:
        """The candidates of each term whose nominal effect suits a fit's residual best.

        Where the fit answers late, nominal effects have the wrong phase on either way: all
        candidates that have one are kept.
        """
        allowed = {(t.name, t.form) for t in terms}
        wanted = [k for k, (t, _) in enumerate(self.places) if (t.name, t.form) in allowed]
        gains = _gains(
            fit, [self.places[k] for k in wanted], fit.nuisance[0] * self.columns[:, wanted]
        )
        own: dict[tuple[str, str], list[tuple[float, int]]] = {}
        for k, (gain, _) in zip(wanted, gains, strict=True):
            term = self.places[k][0]
            own.setdefault((term.name, term.form), []).append((-gain, k))
        late = any(p.term.name in LATE for p in fit.pieces)
        return [
            self.places[k]
            for (name, _), few in own.items()
            for _, k in sorted(few)[: None if late and name in PHASED else most]
        ]


def effects_of(problem: Problem, terms: Sequence[Term]) -> Effects:
    """The nominal effects of all candidates of some terms."""
    nominal = problem.trace(()).seen
    places = [(t, v) for t in terms for v in t.candidates(problem.motion, problem.around)]
    columns = np.empty((len(nominal), len(places)))
    for k, (term, values) in enumerate(places):
        columns[:, k] = problem.trace((Piece(term, values),)).seen - nominal
    return Effects(places, columns)


def screen(fit: Fit, effects: Effects, terms: Sequence[Term], starts: int = 3) -> list[Lead]:
    """The `starts` best candidates of each term beside a fit, best first."""
    ground, predicted = fit.ground, fit.predicted
    places = effects.promising(fit, terms, PROMISING)
    if not places:
        return []
    columns = np.empty((len(predicted), len(places)))
    for k, (term, values) in enumerate(places):
        trace = respond_beside(fit, (*fit.pieces, Piece(term, values)), term)
        columns[:, k] = ground.answer(trace, fit.nuisance) - predicted
    best: dict[tuple[str, str], list[Lead]] = {}
    for (term, values), (gain, factor) in zip(places, _gains(fit, places, columns), strict=True):
        if gain > 0.0:
            scaled = clipped(fit, term, term.scaled(values, factor))
            best.setdefault((term.name, term.form), []).append(Lead(term, scaled, gain))
    leads = [lead for few in best.values() for lead in sorted(few, key=lambda x: -x.gain)[:starts]]
    return sorted(leads, key=lambda lead: -lead.gain)


def _gains(
    fit: Fit, places: Sequence[tuple[Term, np.ndarray]], columns: np.ndarray
) -> list[tuple[float, float]]:
    """Fall of the cost by one step along each column (n, k), and the factor of that step."""
    ground = fit.ground
    d = ground.whiten(columns)
    basis = fit.basis
    d = d - basis @ (basis.T @ d)
    size = np.einsum("ij,ij->j", d, d)
    along = d.T @ fit.innovations
    out = []
    for k, (term, values) in enumerate(places):
        if size[k] <= 1e-9:
            out.append((0.0, 1.0))
            continue
        factor = scale_of(term, values, along[k] / size[k])
        out.append((float(2.0 * factor * along[k] - factor**2 * size[k]), factor))
    return out


def scale_of(term: Term, values: np.ndarray, coefficient: float) -> float:
    """The coefficient, as far as the term can follow it; 1 where it has no size to scale."""
    if np.array_equal(term.scaled(values, 2.0), values):
        return 1.0
    size = float(np.clip(abs(coefficient), *SCALES))
    return size if coefficient > 0.0 else -size


def clipped(fit: Fit, term: Term, values: np.ndarray) -> np.ndarray:
    """Values within the term's bounds."""
    parameters = parameters_of(fit.ground, term)
    return np.clip(values, [p.low for p in parameters], [p.high for p in parameters])


def started(fit: Fit, leads: Sequence[Lead]) -> Fit:
    """The fit with the best of some leads of one term added, not yet improved."""
    trials = []
    for lead in leads:
        pieces = (*fit.pieces, Piece(lead.term, lead.values))
        trials.append(calibrated(fit.ground, pieces, respond_beside(fit, pieces, lead.term)))
    return min(trials, key=lambda trial: trial.cost)

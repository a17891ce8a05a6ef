"""Screening: how much each term could gain beside a fit, by one linear step."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pipeline.discrepancy.fit import Fit, evaluate, jacobian, parameters_of, respond
from pipeline.physics.mechanism import Piece
from pipeline.physics.term import Term

SCALES = (0.1, 8.0)


@dataclass(frozen=True)
class Lead:
    """A term with values worth fitting, and the fall of the cost that a linear step promises."""

    term: Term
    values: np.ndarray
    gain: float


def screen(fit: Fit, terms: Sequence[Term], starts: int = 3) -> list[Lead]:
    """The `starts` best candidates of each term beside a fit, best first."""
    ground = fit.ground
    predicted = fit.predicted
    problem = ground.problem
    places: list[tuple[Term, np.ndarray]] = []
    columns = []
    for term in terms:
        for values in term.candidates(problem.motion, problem.around):
            places.append((term, values))
            trace = respond(ground, (*fit.pieces, Piece(term, values)))
            columns.append(ground.nuisances.columns(trace) @ fit.nuisance - predicted)
    if not columns:
        return []
    d = ground.whiten(np.column_stack(columns))
    known = [ground.whiten(ground.nuisances.columns(fit.trace))]
    if fit.pieces:
        known.append(jacobian(fit))
    basis = np.linalg.qr(np.column_stack(known))[0]
    d = d - basis @ (basis.T @ d)
    size = np.einsum("ij,ij->j", d, d)
    along = d.T @ fit.innovations
    best: dict[tuple[str, str], list[Lead]] = {}
    for k, (term, values) in enumerate(places):
        if size[k] <= 1e-9:
            continue
        factor = scale_of(term, values, along[k] / size[k])
        scaled = clipped(fit, term, term.scaled(values, factor))
        gain = 2.0 * factor * along[k] - factor**2 * size[k]
        if gain > 0.0:
            best.setdefault((term.name, term.form), []).append(Lead(term, scaled, float(gain)))
    leads = [
        lead for few in best.values() for lead in sorted(few, key=lambda x: -x.gain)[:starts]
    ]
    return sorted(leads, key=lambda lead: -lead.gain)


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
    trials = [evaluate(fit.ground, (*fit.pieces, Piece(x.term, x.values))) for x in leads]
    return min(trials, key=lambda trial: trial.cost)

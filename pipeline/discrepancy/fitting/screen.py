"""Screening: how much each term could gain beside a fit, by one linear step."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pipeline.discrepancy.fitting.effects import Effects, gains_of, sized_of
from pipeline.discrepancy.fitting.fit import (
    Fit,
    calibrated,
    followed,
    moved_by,
    parameters_of,
    respond_beside,
)
from pipeline.discrepancy.fitting.moments import moments
from pipeline.physics.piece import Piece
from pipeline.physics.term import Term

PROMISING = 4
SURPRISING = 3


@dataclass(frozen=True)
class Lead:
    """A term with values worth fitting, and the fall of the cost that a linear step promises."""

    term: Term
    values: np.ndarray
    gain: float


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

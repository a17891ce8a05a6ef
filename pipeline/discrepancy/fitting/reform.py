"""The forms of a term: a fit with another form in the place of one."""

import numpy as np

from pipeline.discrepancy.fitting.effects import gains_of
from pipeline.discrepancy.fitting.fit import (
    Fit,
    calibrated,
    evaluate,
    improve,
    parameters_of,
    respond_beside,
)
from pipeline.discrepancy.fitting.ground import Box
from pipeline.discrepancy.fitting.moments import settle_moments
from pipeline.discrepancy.fitting.screen import PROMISING
from pipeline.physics.piece import Piece
from pipeline.physics.term import Term

MOST, BEGUN = 10, 3


def reformed(fit: Fit, place: int, term: Term) -> Fit:
    """The fit with another form of a term, or another term, begun from the values that both have.

    Where neither has all of the other's, it begins anew. Where starts lie far apart, each is judged
    after a few steps: one that is near the truth may begin farther from the data than one that is
    not.
    """
    old = fit.pieces[place]
    had = [p.name for p in parameters_of(fit.ground, old.term)]
    names = [p.name for p in parameters_of(fit.ground, term)]
    problem = fit.ground.problem
    starts = term.candidates(problem.motion, problem.around)
    same_place = term.before_curve == old.term.before_curve
    nested = set(had) <= set(names) or set(names) <= set(had)
    if same_place and (nested or term.scanned):
        kept = starts.copy()
        for value, name in zip(old.values, had, strict=True):
            if name in names:
                kept[:, names.index(name)] = value
        box = fit.ground.box(term)
        told = _within(box, term.retold(np.unique(kept, axis=0)))
        fresh = starts if term.own_law else starts[:0]
        clipped = np.unique(np.clip(kept, box.low, box.high), axis=0)
        starts = np.vstack([told, fresh]) if len(told) else clipped
    before, after = fit.pieces[:place], fit.pieces[place + 1 :]
    if term.scanned and not set(names) <= set(had):
        starts = _sized(fit, place, term, starts, nested)
    trials = []
    for values in starts:
        pieces = (*before, Piece(term, values), *after)
        trace = respond_beside(fit, pieces, old.term, term)
        trials.append(calibrated(fit.ground, pieces, trace))
    trials.sort(key=lambda t: t.cost)
    begun: Fit | None = fit
    if term.far_apart:
        trials = sorted((improve(t, BEGUN, fit) for t in trials[:MOST]), key=lambda t: t.cost)
        begun = None
    return min((settle_moments(improve(t, 8, begun)) for t in trials[:2]), key=lambda t: t.cost)


def _within(box: Box, starts: np.ndarray) -> np.ndarray:
    """Those of some starts (k, p) that are within a term's bounds."""
    return np.asarray(starts[np.all((starts >= box.low) & (starts <= box.high), axis=1)])


def _sized(fit: Fit, place: int, term: Term, starts: np.ndarray, nested: bool) -> np.ndarray:
    """The starts (k, p) of a scanned form that promise most, each in the size that suits it.

    nested: whether the fit has the plainer form; else what another one has beyond that goes first.
    """
    before, after = fit.pieces[:place], fit.pieces[place + 1 :]
    if not nested:
        alone = Piece(term, term.resized(starts[0], 0.0))
        fit = evaluate(fit.ground, (*before, alone, *after))
    traces = [respond_beside(fit, (*before, Piece(term, v), *after), term) for v in starts]
    answers = [fit.ground.answer(t, fit.nuisance) for t in traces]
    columns = np.column_stack(answers) - fit.predicted[:, None]
    gains, factors = gains_of(fit, np.ones(len(starts), dtype=bool), columns)
    best = np.argsort(-gains)[:PROMISING]
    return np.array([term.resized(starts[k], factors[k]) for k in best])

"""Slips at once: what noise that walks or jitters much may be instead."""

from itertools import pairwise

import numpy as np

from pipeline.discrepancy.fitting.fit import Fit, evaluate, improve
from pipeline.discrepancy.fitting.moments import settle_moments
from pipeline.discrepancy.search.elsewhere import differing
from pipeline.discrepancy.search.weighing import FAINT, MOST_TERMS, Choice, Search
from pipeline.physics.catalogue import RECURRING
from pipeline.physics.lost_steps import LostSteps
from pipeline.physics.piece import Piece

SLIPS = [LostSteps(form) for form in ("twice", "thrice", "fourfold")]
USUAL_JITTER = 3
MOMENTS, SHORTEST, BEGUN, SETTLED = 150, 4, 2, 2


def stepped(search: Search, choice: Choice) -> Choice:
    """The choice with slips in place of a zero that walks or jitters much, if that is better.

    A slip that is taken back, or followed by others as large, is not half explained by one: no
    single step leads to two, nor to one in every cycle. Beside slips a zero may still jitter: what
    they promise is their gain on noise that does not.
    """
    _, jitter, walk = choice.place
    rest = [p for p in choice.fit.pieces if not p.term.slow]
    restless = walk > 0 or jitter > USUAL_JITTER or len(rest) < len(choice.fit.pieces)
    known = any(t.name == LostSteps.name for t in search.terms)
    if not (restless and known) or len(rest) >= MOST_TERMS:
        return choice
    still, place = search.stilled(evaluate(choice.fit.ground, rest), choice.place, 4)
    motion, around = still.ground.problem.motion, still.ground.problem.around
    count = still.ground.count
    few = [slip for slip in SLIPS if count >= SHORTEST * (slip.times + 1)]
    slips = [
        Piece(term, steps(still, slip.times))
        for slip in few
        for term in (slip, *differing(slip.elsewhere(), still))
    ]
    slips += [Piece(t, v) for t in RECURRING for v in t.candidates(motion, around)]
    trials = [improve(evaluate(still.ground, [*still.pieces, s]), BEGUN) for s in slips]
    best = {t.key: t for t in sorted(trials, key=lambda t: -t.cost)}.values()
    ahead = sorted(map(improve, best), key=lambda t: search.hoped(t, place))[:SETTLED]
    fit = min((settle_moments(t) for t in ahead), key=lambda t: search.hoped(t, place))
    if search.hoped(fit, place) > search.hoped(still, place) - FAINT:
        return choice
    return min(choice, search.weighed(fit, place), key=lambda c: c.score)


def steps(fit: Fit, count: int) -> np.ndarray:
    """Jump and time of the `count` slips that leave least of a fit's residual, (2 count,).

    Between them it has levels; of all sets of MOMENTS rows that one counts that explains the
    largest sum of squares, found by dynamic programming (Bellman, Comm. ACM 4 (1961) 284).
    """
    ground = fit.ground
    rows = np.flatnonzero(ground.used)
    left = (ground.problem.measured - fit.predicted)[rows]
    sums = np.concatenate([[0.0], np.cumsum(left - left.mean())])
    ends = np.unique(np.linspace(0, len(rows), MOMENTS).astype(int))
    long = ends[None, :] - ends[:, None]
    told = (sums[ends][None, :] - sums[ends][:, None]) ** 2 / np.maximum(long, 1)
    told[long < SHORTEST] = -np.inf
    best, before = told[0], []
    for _ in range(count):
        through = best[:, None] + told
        before.append(np.argmax(through, axis=0))
        best = through.max(axis=0)
    at = [len(ends) - 1]
    for last in before[::-1]:
        at.append(int(last[at[-1]]))
    bounds = [0, *ends[at[:0:-1]], len(rows)]
    levels = [left[i:j].mean() for i, j in pairwise(bounds)]
    slope = ground.problem.curve.slope
    jumps = np.diff(levels) / (slope if slope != 0.0 else 1.0)
    times = ground.problem.motion.time_s[rows[bounds[1:-1]]] - 1e-6
    return np.column_stack([jumps, times]).ravel()

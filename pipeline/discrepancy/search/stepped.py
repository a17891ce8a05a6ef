"""Slips at once: what noise that walks or jitters much may be instead."""

import numpy as np

from pipeline.discrepancy.fitting.fit import Fit, evaluate, improve
from pipeline.discrepancy.fitting.moments import settle_moments
from pipeline.discrepancy.search.choose import FAINT, MOST_TERMS, Choice, Search
from pipeline.physics.catalogue import RECURRING
from pipeline.physics.lost_steps import LostSteps
from pipeline.physics.mechanism import Piece

SLIPS = LostSteps("twice")
USUAL_JITTER = 3
MOMENTS, BEGUN = 150, 2


def stepped(search: Search, choice: Choice) -> Choice:
    """The choice with slips in place of a zero that walks or jitters much, if that is better.

    A slip that is taken back, or followed by others as large, is not half explained by one: no
    single step leads to two, nor to one in every cycle. Beside slips a zero may still jitter: what
    they promise is their gain on noise that does not.
    """
    _, jitter, walk = choice.place
    rest = [p for p in choice.fit.pieces if not p.term.slow]
    restless = walk > 0 or jitter > USUAL_JITTER or len(rest) < len(choice.fit.pieces)
    known = any(t.name == SLIPS.name for t in search.terms)
    if not (restless and known) or len(rest) >= MOST_TERMS or search.family.prior.repeats == 0:
        return choice
    still, place = search.stilled(evaluate(choice.fit.ground, rest), choice.place, 4)
    motion, around = still.ground.problem.motion, still.ground.problem.around
    slips = [Piece(SLIPS, two_steps(still))]
    slips += [Piece(t, v) for t in RECURRING for v in t.candidates(motion, around)]
    trials = [improve(evaluate(still.ground, [*still.pieces, s]), BEGUN) for s in slips]
    best = {t.key: t for t in sorted(trials, key=lambda t: -t.cost)}.values()
    fit = min((settle_moments(improve(t)) for t in best), key=lambda t: t.cost)
    if search.hoped(fit, place) > search.hoped(still, place) - FAINT:
        return choice
    return min(choice, search.weighed(fit, place), key=lambda c: c.score)


def two_steps(fit: Fit) -> np.ndarray:
    """Jump and time of the two slips that leave least of a fit's residual, (4,).

    Between them it has three levels; of all pairs of MOMENTS rows those count that explain the
    largest sum of squares.
    """
    ground = fit.ground
    rows = np.flatnonzero(ground.used)
    left = (ground.problem.measured - fit.predicted)[rows]
    sums = np.concatenate([[0.0], np.cumsum(left - left.mean())])
    ends = np.unique(np.linspace(4, len(rows) - 4, MOMENTS).astype(int))
    at, first, second = sums[ends], ends[:, None], ends[None, :]
    between = np.maximum(second - first, 1)
    told = at[:, None] ** 2 / first + (at[None, :] - at[:, None]) ** 2 / between
    told += at[None, :] ** 2 / (len(rows) - second)
    one, two = np.unravel_index(np.argmax(np.where(second > first, told, 0.0)), told.shape)
    i, j = int(ends[one]), int(ends[two])
    levels = np.array([left[:i].mean(), left[i:j].mean(), left[j:].mean()])
    slope = ground.problem.curve.slope
    jumps = np.diff(levels) / (slope if slope != 0.0 else 1.0)
    times = ground.problem.motion.time_s[rows[[i, j]]] - 1e-6
    return np.array([jumps[0], times[0], jumps[1], times[1]])

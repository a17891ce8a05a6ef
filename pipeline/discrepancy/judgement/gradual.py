"""A slip that lies among held-out rows, which show that the zero went there gradually."""

from dataclasses import replace

import numpy as np

from pipeline.discrepancy.fitting.moments import moments_of, moved
from pipeline.discrepancy.judgement.borne_out import likeliest_without
from pipeline.discrepancy.judgement.rivals import predicted_by
from pipeline.discrepancy.model.intervals import moment_interval
from pipeline.discrepancy.problem.problem import Problem
from pipeline.discrepancy.search.explain import Explanation
from pipeline.discrepancy.search.weighing import Choice
from pipeline.physics.lost_steps import LostSteps

FEWEST, SURE = 10, 30.0


def unless_gradual(problem: Problem, explanation: Explanation, best: Choice) -> Choice:
    """The best choice, without its slips where held-out rows show one of them to be none.

    Between the rows that were fitted a slip may be anywhere: the held-out ones there are at one
    level until some row and its jump away after it, wherever that level is, or on a way from here
    to there, which a line follows surely better.
    """
    for k, piece in enumerate(best.fit.pieces):
        if isinstance(piece.term, LostSteps):
            for j in moments_of(best.fit, piece):
                if is_gradual(problem, best, k, j):
                    return likeliest_without(explanation, best, LostSteps.name)
    return best


def is_gradual(problem: Problem, best: Choice, k: int, j: int) -> bool:
    """Whether held-out rows about that moment (parameter j of piece k) are at no two levels."""
    low_s, high_s = moment_interval(best.fit, k, j)
    time_s = problem.motion.time_s
    between = (time_s > low_s) & (time_s < high_s)
    rows = np.flatnonzero(between & problem.heldout & np.isfinite(problem.measured))
    if len(rows) < FEWEST:
        return False
    late, early = (
        predicted_by(problem, replace(best, fit=moved(best.fit, k, j, at_s)))[rows]
        for at_s in (high_s, low_s)
    )
    off, noise = problem.measured[rows] - late, best.fit.ground.noise
    better = left_by_levels(off, early - late) - left_by_line(time_s[rows], off)
    return better > SURE * noise.deviation**2 * noise.alike


def left_by_line(time_s: np.ndarray, off: np.ndarray) -> float:
    """Sum of squares that a line in time leaves of (k,) residuals."""
    line = np.polynomial.Polynomial.fit(time_s, off, 1)
    return float(np.sum((off - line(time_s)) ** 2))


def left_by_levels(off: np.ndarray, jump: np.ndarray) -> float:
    """The same of one level until the best row, and one that is a jump (k,) away from there on."""
    slipped = np.array(
        [np.where(np.arange(len(off)) < k, off, off - jump) for k in range(len(off))]
    )
    return float(np.min(np.var(slipped, axis=1))) * len(off)

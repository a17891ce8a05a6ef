"""Fewer rows to fit on than a recording has."""

from dataclasses import replace

import numpy as np

from pipeline.discrepancy.problem.problem import Problem
from pipeline.discrepancy.problem.repeats import same_motions
from pipeline.discrepancy.problem.rows import Picked, turned_between
from pipeline.physics.held import STEP_AND_WAIT_S
from pipeline.recording import reversals_of

WHOLE = 6000  # rows: of a recording and the block that it asked for, run twice
MOST_ROWS = 3000
ALIKE = 4
MOST_SAMPLES, SEARCHED = 60_000, 12_000
STANDS_OUT = 1e-3


def thinned(problem: Problem, whole: bool = False) -> tuple[Problem, int]:
    """The rows to fit on, and k: all if they are few, of more every k-th and all reversals.

    These are at most about MOST_ROWS. At most about MOST_SAMPLES samples stand behind them for
    terms that go by time. Rows after the last one to fit on tell a fit nothing and are left out,
    unless the whole is asked for.
    """
    if not whole:
        problem = problem.rows(np.arange(np.flatnonzero(problem.train)[-1] + 1))
    if len(problem.motion) <= few(problem):
        return problem, 1
    every = spacing(problem)
    coarse = -(-len(problem.motion) // MOST_SAMPLES)
    fine = problem.rows(every_kth(problem, coarse)) if coarse > 1 else problem
    keep = every_kth(fine, spacing(fine))
    turned = turned_between(fine.motion, keep, STANDS_OUT)
    return replace(fine.rows(keep), picked=Picked(fine.motion, keep, turned)), every


def spacing(problem: Problem) -> int:
    """Of how many measured rows one is fitted."""
    count = int(np.isfinite(problem.measured).sum())
    return 1 if count <= few(problem) else -(-count // MOST_ROWS)


def few(problem: Problem) -> int:
    """Up to how many rows are all fitted: WHOLE where a robot steps and waits, MOST_ROWS elsewhere.

    Each row is a pose of its own there; of a motion that goes on neighbours say nearly the same.
    """
    return WHOLE if problem.around.dwell_s >= STEP_AND_WAIT_S else MOST_ROWS


def sparser(problem: Problem) -> Problem:
    """The same rows with at most about SEARCHED samples behind them, which a search needs no more.

    What has been found on them is to be fitted again on all.
    """
    picked = problem.picked
    if picked is None or len(picked.motion) <= SEARCHED:
        return problem
    every = np.arange(0, len(picked.motion), -(-len(picked.motion) // SEARCHED))
    kept = np.union1d(every, np.union1d(picked.rows, picked.turned))
    rows, turned = (np.searchsorted(kept, those) for those in (picked.rows, picked.turned))
    return replace(problem, picked=Picked(picked.motion.rows(kept), rows, turned))


def every_kth(problem: Problem, k: int) -> np.ndarray:
    """Every k-th row of a problem that was measured and all reversals, as indices.

    Of ALIKE cycles that repeat each other the same steps, whatever frames were lost: else they
    would repeat no more, and nothing would tell their noise. The next ALIKE keep the steps after
    those, so that what happens between two steps of the first is seen as well.
    """
    measured = np.isfinite(problem.measured)
    keep, alone = np.zeros(len(measured), dtype=bool), measured.copy()
    for rows in same_motions(problem):
        known = (rows >= 0) & measured[rows]
        steps = np.flatnonzero(known.any(axis=0))
        turns = np.minimum(np.arange(len(rows)), max(len(rows) - ALIKE, 0)) // ALIKE % k
        for row, seen, turn in zip(rows, known, turns, strict=True):
            kept = steps[turn::k]
            keep[row[kept][seen[kept]]] = True
        alone[rows[rows >= 0]] = False
    keep[np.flatnonzero(alone)[::k]] = True
    for signal in (problem.motion.drive, *problem.motion.others.values()):
        keep[reversals_of(signal)] = True
    return np.flatnonzero(keep)

"""The proof: what a prediction by commands alone leaves, on held-out samples, too."""

from dataclasses import replace

import numpy as np

from pipeline.discrepancy.choose import Choice
from pipeline.discrepancy.cycle_zero import about_each_zero, wanders_by_cycle
from pipeline.discrepancy.explain import Explanation, settled_rows
from pipeline.discrepancy.intervals import undated
from pipeline.discrepancy.outliers import isolated
from pipeline.discrepancy.problem import Problem
from pipeline.discrepancy.structure import (
    CHANCE,
    SLOW_CORRELATION,
    SMALLEST_SIZE,
    Structure,
    mismatch_variance,
    rounded,
)
from pipeline.discrepancy.wander import comes_back

TWICE, HALF = 2.0, 0.5
HELDOUT = "on held-out samples, which the fit to the others does not predict"
SLOWLY = "slow changes that come back, as no zero that wanders does"


def disproved(
    problem: Problem,
    explanation: Explanation,
    choice: Choice,
    off: np.ndarray,
    structure: Structure,
) -> Structure:
    """The structure that shows where every row is predicted from the start of the recording.

    off: (n,) measurement minus that prediction, over all samples of the problem. Lone rows, and
    those between which a slip may lie, are not counted. The noise that goes with the fit may walk,
    and so take for noise what follows the commands slowly: then a slow part that comes back to its
    level is surely likelier than a walk of any size (`wander.py`). Where each cycle has another
    zero, that is taken off. Of a force against motion, whose rest is slow in any case, that is not
    asked.
    """
    lone = isolated(off, problem.train, explanation.prior.finest)
    counted = ~lone & ~undated(choice.fit, problem.motion.time_s)
    if wanders_by_cycle(choice):
        off = about_each_zero(off, problem.cycle, counted & np.isfinite(off))
    if refuted(problem, off, counted):
        return replace(structure, found=True, where=HELDOUT)
    if problem.derivatives is not None or rounded(explanation, choice):
        return structure
    noise = choice.fit.ground.noise
    used = counted & settled_rows(problem, explanation.prior) & (problem.train | problem.heldout)
    stands = problem.motion.stands
    gain, likely = comes_back(off, problem.cycle, used, stands, noise, SLOW_CORRELATION)
    large = likely.correlated > SMALLEST_SIZE * noise.deviation
    if not (large and likely.correlation > SLOW_CORRELATION and gain > -2.0 * np.log(CHANCE)):
        return structure
    share = min(likely.correlated**2 / mismatch_variance(explanation), 1.0)
    p_value = min(structure.p_value, float(np.exp(-0.5 * gain)))
    return Structure(True, SLOWLY, share, p_value, wandering=likely)


def refuted(problem: Problem, off: np.ndarray, counted: np.ndarray) -> bool:
    """Whether the held-out rows refute what the training rows seemed to say.

    They do where the error `off` (n,) on counted rows (n,) is there over twice that on training
    rows and half of what it was before.
    """
    train, heldout = problem.train & counted, problem.heldout & counted
    before = (problem.measured - problem.simulated)[heldout]
    left = root_mean(off[heldout] ** 2)
    return left > TWICE * root_mean(off[train] ** 2) and left > HALF * root_mean(before**2)


def root_mean(square: np.ndarray) -> float:
    """Root mean square, given squares; NaN of none."""
    return float(np.sqrt(np.mean(square))) if len(square) else float("nan")

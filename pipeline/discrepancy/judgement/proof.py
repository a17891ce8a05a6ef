"""The proof: what a prediction by commands alone leaves, on held-out samples, too."""

from dataclasses import replace

import numpy as np
from scipy.special import fdtri

from pipeline.discrepancy.judgement.cycle_zero import about_each_zero, wanders_by_cycle
from pipeline.discrepancy.judgement.slipped_again import slipped_again
from pipeline.discrepancy.judgement.structure import (
    CHANCE,
    SMALLEST_SIZE,
    Structure,
    mismatch_variance,
    rounded,
)
from pipeline.discrepancy.judgement.walking_zero import walks_far
from pipeline.discrepancy.model.intervals import undated
from pipeline.discrepancy.model.result import root_mean
from pipeline.discrepancy.noise.noise import SLOW_CORRELATION, NoiseModel
from pipeline.discrepancy.noise.wander import comes_back
from pipeline.discrepancy.problem.problem import Problem
from pipeline.discrepancy.search.counted import set_aside, settled_rows
from pipeline.discrepancy.search.explain import Explanation
from pipeline.discrepancy.search.refuted import refuted as unrepeated
from pipeline.discrepancy.search.weighing import FAR_WALK, Choice

TWICE, HALF, FAR, SURE = 2.0, 0.5, 1.5, 3.0
FEWEST_BEYOND, SELDOM = 20, 0.005
HELDOUT = "on held-out samples, which the fit to the others does not predict"
SLOWLY = "slow changes that come back, as no zero that wanders does"
BEYOND = "at held-out commands beyond the range of those fitted"
UNWITNESSED = "slow changes that may be a zero that walks, but no cycle repeats to show it"
WALKS = "a zero that walks by many times the noise, which no commands foretell"
UNLIKE_REPEATS = "slow changes that are no zero that walks, as cycles that repeat show"


def disproved(
    problem: Problem,
    explanation: Explanation,
    choice: Choice,
    predicted: np.ndarray,
    structure: Structure,
) -> Structure:
    """The structure that shows where every row is predicted from the start of the recording.

    predicted: (n,) over all samples of the problem. Lone and late rows, and those between which a
    slip may lie, are not counted. The noise that goes with the fit may walk,
    and so take for noise what follows the commands slowly: then a slow part that comes back to its
    level is surely likelier than a walk of any size (`wander.py`). How slow it is, is a matter of
    measured samples, not of rows between them. Where each cycle has another zero, that is taken
    off. Of a force against motion, whose rest is slow in any case, that is not asked.
    """
    noise = choice.fit.ground.noise
    off, counted = counted_errors(problem, explanation, choice, predicted)
    if refuted(problem, off, counted):
        return replace(structure, found=True, where=HELDOUT)
    if problem.derivatives is not None or rounded(explanation, choice):
        return structure
    used = counted & settled_rows(problem, explanation.prior) & (problem.train | problem.heldout)
    walking = taken_for_a_walk(explanation, choice, off[used & problem.train])
    if walking is not None:
        return replace(structure, found=True, where=walking)
    rows = np.flatnonzero(np.isfinite(problem.measured))
    motion = problem.motion.rows(rows)
    gain, likely = comes_back(
        off[rows], motion.cycle, used[rows], motion.stands, noise, SLOW_CORRELATION
    )
    large = likely.correlated > SMALLEST_SIZE * noise.deviation
    if not (large and likely.correlation > SLOW_CORRELATION and gain > -2.0 * np.log(CHANCE)):
        return structure
    share = min(likely.correlated**2 / mismatch_variance(explanation), 1.0)
    p_value = min(structure.p_value, float(np.exp(-0.5 * gain)))
    return Structure(True, SLOWLY, share, p_value, wandering=likely)


def counted_errors(
    problem: Problem, explanation: Explanation, choice: Choice, predicted: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Errors (n,) of a prediction (n,), and the rows (n,) that count.

    Each cycle's zero is taken off where these differ or it walks far, and so is a slip more where
    slips are named.
    """
    again = slipped_again(problem, choice, predicted)
    predicted = predicted if again is None else again.predicted
    off = problem.measured - predicted
    lone = set_aside(problem, predicted, explanation.prior)
    counted = ~lone & ~undated(choice.fit, problem.motion.time_s)
    if wanders_by_cycle(choice) or walks_far(explanation, choice):
        off = about_each_zero(off, problem.cycle, counted & np.isfinite(off))
    return off, counted


def refuted(problem: Problem, off: np.ndarray, counted: np.ndarray) -> bool:
    """Whether the held-out rows refute what the training rows seemed to say.

    They do where the error `off` (n,) on counted rows (n,) is there over twice that on training
    rows and half of what it was before. What lies beyond the commands fitted refutes nothing.
    """
    heldout = within(problem, counted)
    before = (problem.measured - problem.simulated)[heldout]
    left, fitted = root_mean(off[heldout] ** 2), root_mean(off[problem.train & counted] ** 2)
    return left > TWICE * fitted and left > HALF * root_mean(before**2)


def strained(
    problem: Problem,
    off: np.ndarray,
    counted: np.ndarray,
    noise: NoiseModel,
    farthest: float = FAR_WALK,
) -> str | None:
    """Where held-out rows (as in `disproved`) are off by more than usual, though none refuted.

    Names stay then: they may hold, though not all is said; what holds between the commands that
    were fitted holds there all the same if it errs beyond them. A zero that walks by more than
    `farthest` times the noise's variance is not all said either; at which level it does, is a
    matter of where it began.
    """
    left = off[problem.train & counted]
    if noise.walk > 0.0:
        off = off - np.mean(left)
        left = left - np.mean(left)
        if np.var(left) > farthest * noise.deviation**2:
            return WALKS
    zeros = zeros_apart(problem, off, counted) if noise.jitter > 0.0 else 0.0
    apart = float(np.hypot(FAR * noise.deviation, zeros))
    other = off[within(problem, counted)]
    if root_mean(other**2) > max(usual(left, noise, len(other)), apart):
        return HELDOUT
    far = off[problem.heldout & counted & beyond(problem)]
    if len(far) >= FEWEST_BEYOND and root_mean(far**2) > max(usual(left, noise, len(far)), apart):
        return BEYOND
    return None


def zeros_apart(problem: Problem, off: np.ndarray, counted: np.ndarray) -> float:
    """How far held-out cycles' zeros are to be expected from the trained ones', which jitter.

    Of few cycles the jitter is hardly known: the ratio of two variances (F), by chance SELDOM.
    """
    cycle = problem.cycle
    trained, heldout = (
        np.array([np.mean(off[rows & (cycle == c)]) for c in np.unique(cycle[rows])])
        for rows in (problem.train & counted, problem.heldout & counted)
    )
    if len(trained) < 2 or not len(heldout):
        return 0.0
    ratio = float(fdtri(len(heldout), len(trained) - 1, 1.0 - SELDOM))
    return float(np.std(trained, ddof=1)) * float(np.sqrt(ratio))


def within(problem: Problem, counted: np.ndarray) -> np.ndarray:
    """Held-out rows (n,) that count, without those beyond the commands fitted if any is left."""
    heldout = problem.heldout & counted
    inside = heldout & ~beyond(problem)
    return inside if np.any(inside) else heldout


def beyond(problem: Problem) -> np.ndarray:
    """Rows (n,) whose command is beyond the range of those to fit on."""
    drive = problem.motion.drive
    fitted = drive[problem.train]
    return (drive < fitted.min()) | (drive > fitted.max())


def usual(left: np.ndarray, noise: NoiseModel, count: int) -> float:
    """The largest error of `count` other rows to be expected, given what those fitted leave, (k,).

    A zero that walks is elsewhere in other rows, and so is one that jumps by the cycle. Where few
    rows say something of their own, their errors differ more: by a share of sqrt(1 / 2 n) each, n
    of those that are not alike.
    """
    own = max(root_mean(left**2), float(np.hypot(noise.deviation, 2.0 * noise.jitter)))
    chance = SURE * np.sqrt(0.5 * noise.alike * (1.0 / max(len(left), 1) + 1.0 / max(count, 1)))
    return max(TWICE if noise.walk > 0.0 else FAR, float(np.exp(chance))) * own


def taken_for_a_walk(explanation: Explanation, choice: Choice, left: np.ndarray) -> str | None:
    """Whether a zero that walks takes most of what names leave, (k,), and no cycles bear it out.

    What a recording samples finely it changes slowly, physics and zero alike: only cycles that
    repeat would witness that it is the zero. Where they do, they may speak against it.
    """
    noise = choice.fit.ground.noise
    most = root_mean(left**2) > TWICE * float(np.hypot(noise.deviation, noise.jitter))
    if not (choice.fit.pieces and noise.walk > 0.0 and most):
        return None
    if explanation.prior.repeats == 0:
        return UNWITNESSED
    return UNLIKE_REPEATS if unrepeated(explanation.search, choice) else None

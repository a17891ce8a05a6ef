"""Which rows count: those that the mechanism answers to, and in which nothing was mistaken."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from pipeline.discrepancy.noise.learning import NoisePrior
from pipeline.discrepancy.problem.late import LateFrames, late_frames, none_late
from pipeline.discrepancy.problem.outliers import (
    alike,
    at_commands,
    distances,
    isolated,
    longest_burst,
    returning,
)
from pipeline.discrepancy.problem.problem import Problem
from pipeline.discrepancy.problem.repeats import driven_again
from pipeline.discrepancy.problem.travelled import about_reversals
from pipeline.discrepancy.search.weighing import Choice
from pipeline.physics.lost_steps import LostSteps
from pipeline.recording import reversals_of

MOST_UNSETTLED, MOST_UNREPEATED = 0.3, 0.1
SAME_RANGE = 0.6
SAME_LEVEL = 0.05
SAME_COMMAND = 0.5
TURN_ROWS = 2
INCREDIBLE, MOST_INCREDIBLE = 4.3, 0.03
TAKEN_BACK = 0.3
FEWEST_BEYOND = 3


def mistaken_rows(problem: Problem, choice: Choice, prior: NoisePrior) -> np.ndarray:
    """Outliers of a choice's residual: isolated rows, and few that its noise finds incredible.

    Rows that the choice was not fitted to are judged by their distance alone.
    """
    fit = choice.fit
    off = np.where(problem.train, problem.measured - fit.predicted, np.nan)
    repeats = repeats_of(problem, prior)
    out = np.zeros(len(off), dtype=bool)
    incredible = np.flatnonzero(fit.ground.used)[np.abs(fit.innovations) > INCREDIBLE]
    if len(incredible) < MOST_INCREDIBLE * fit.ground.count:
        alone = np.diff(incredible, prepend=-9) > 1
        out[incredible[alone]] = True
    left_out = problem.train & settled_rows(problem, prior) & ~fit.ground.used
    out |= left_out & (np.abs(off) > INCREDIBLE * fit.ground.noise.deviation)
    out &= ~returning(distances(off), repeats)
    out |= isolated(off, problem.train, prior.finest, problem.cycle, repeats)
    out &= ~(usual(problem, off, prior) | leaping(problem, choice))
    out &= ~farthest(problem, off, out)
    late = problem.train & late_rows(problem, fit.predicted, prior, repeats).aside
    return out | between_slips(problem, choice) | late


def late_rows(
    problem: Problem,
    predicted: np.ndarray,
    prior: NoisePrior,
    repeats: Sequence[np.ndarray] = (),
) -> LateFrames:
    """Which rows show another pose, see `late_frames`; no rows of a force.

    None either where the rows are not all samples.
    """
    if problem.motion.kinetics is not None or problem.picked is not None:
        return none_late(len(predicted))
    measured, train = problem.measured, problem.train
    return late_frames(measured, predicted, train, prior.finest, problem.cycle, repeats)


def set_aside(problem: Problem, predicted: np.ndarray, prior: NoisePrior) -> np.ndarray:
    """Rows (n,), held-out ones too, that are mistaken or late as a prediction (n,) says."""
    off = problem.measured - predicted
    again = () if problem.motion.kinetics is None else driven_again(problem)
    odd = isolated(off, problem.train, prior.finest, problem.cycle, again)
    late = late_rows(problem, predicted, prior, [alike_rows(problem)]).aside
    return np.asarray(odd | late | problem.mistaken)


def between_slips(problem: Problem, choice: Choice) -> np.ndarray:
    """Training rows (n,) between two slips of which the second takes back the first at once.

    A shaft does not slip back to where it was within a few samples: there the camera saw another
    thing, too near to stand off from each sample's noise. So are those after a slip that only the
    last few show: nothing tells whether it stays.
    """
    out, time_s = np.zeros(len(problem.motion), dtype=bool), problem.motion.time_s
    for piece in choice.fit.pieces:
        if not isinstance(piece.term, LostSteps):
            continue
        jumps, times_s = piece.values[0::2], piece.values[1::2]
        spans = [(times_s[-1], np.inf)]
        for (jump, back), span in zip(pairwise(jumps), pairwise(times_s), strict=True):
            if abs(jump + back) < TAKEN_BACK * abs(jump):
                spans.append(span)
        for first_s, last_s in spans:
            between = problem.train & (time_s >= first_s) & (time_s < last_s)
            out |= between & (between.sum() <= longest_burst(problem.cycle))
    return out


def leaping(problem: Problem, choice: Choice) -> np.ndarray:
    """Rows (n,) at which a term of a choice leaps by itself; none where they were picked."""
    out = np.zeros(len(problem.motion), dtype=bool)
    if problem.picked is None:
        for piece in choice.fit.pieces:
            out |= piece.term.leaps(problem.motion, choice.fit.trace.body, piece.values)
    return out


def usual(problem: Problem, off: np.ndarray, prior: NoisePrior) -> np.ndarray:
    """Rows (n,) whose residual `off` (n,) stands off for a reason.

    That is a turn, or where a stop of several samples begins as at others.
    """
    stands = problem.motion.stands
    arriving = ~stands & np.append(stands[1:], False)
    return turning(problem) | alike(off, arriving, prior.finest)


def farthest(problem: Problem, off: np.ndarray, out: np.ndarray) -> np.ndarray:
    """Rows (n,) of those in `out` that are all there are beyond a command, or a force's speed."""
    drive, kinetics = problem.motion.drive, problem.motion.kinetics
    signals = [drive] if kinetics is None else [drive, kinetics.velocity]
    return np.logical_or.reduce([all_beyond(signal, off, out) for signal in signals])


def all_beyond(drive: np.ndarray, off: np.ndarray, out: np.ndarray) -> np.ndarray:
    """Rows (n,) of those in `out` that are all there are beyond a drive (n,), off to the same side.

    So a joint meets a stop where it was seldom driven as far; mistakes fall anywhere. At least
    FEWEST_BEYOND of those whose residuals `off` (n,) are known.
    """
    found = np.zeros(len(off), dtype=bool)
    known = np.flatnonzero(np.isfinite(off))
    for way in (1.0, -1.0) if len(known) else ():
        rows = known[np.argsort(-way * drive[known])]
        alike = out[rows] & (off[rows] * off[rows[0]] > 0.0)
        edge = drive[rows[np.argmin(alike)]]
        beyond = rows[way * (drive[rows] - edge) > 0.0]
        if len(beyond) >= FEWEST_BEYOND:
            found[beyond] = True
    return found


def repeats_of(problem: Problem, prior: NoisePrior) -> list[np.ndarray]:
    """Row numbers (repeats, steps) of cycles that repeat each other, and of equal commands.

    Of a force, repeats tell no noise (`noise_of_force`), but they tell where it leaps each time.
    """
    again = prior.groups if problem.motion.kinetics is None else driven_again(problem)
    return [*again, alike_rows(problem)]


def alike_rows(problem: Problem) -> np.ndarray:
    """Row numbers (most, k) of equal commands on either branch, see `at_commands`."""
    return at_commands(problem.motion.drive, SAME_COMMAND * problem.around.step)


def turning(problem: Problem) -> np.ndarray:
    """Rows (n,) next to a reversal of a motion that a force is measured against.

    There dry friction jumps within a row or two: that is a corner and no outlier.
    """
    if problem.motion.kinetics is None:
        return np.zeros(len(problem.motion), dtype=bool)
    return about_reversals(problem.motion.drive, TURN_ROWS)


def settled_rows(problem: Problem, prior: NoisePrior) -> np.ndarray:
    """Rows from the first reversal on: before it, the mechanism may remember an earlier motion.

    All rows where that would cost more than three tenths of them, or more than a tenth where
    neither a cycle repeats another nor a later stroke the first. All rows, too, of a force where no
    later rows to fit on go nearly as far: no simulated curve says what a force is there.
    """
    out = np.ones(len(problem.motion), dtype=bool)
    drive = problem.motion.drive
    turns = reversals_of(drive)
    again = prior.repeats > 0 or strokes_again(drive, turns)
    most = MOST_UNSETTLED if again else MOST_UNREPEATED
    if not (len(turns) and turns[0] < most * len(out)):
        return out
    out[: turns[0]] = False
    later = drive[out & problem.train]
    far = len(later) and np.ptp(later) > SAME_RANGE * np.ptp(drive[problem.train])
    return out if far or problem.motion.kinetics is None else np.ones_like(out)


def strokes_again(drive: np.ndarray, turns: np.ndarray) -> bool:
    """Whether a drive (n,) that turns at `turns` makes the stroke that it begins with again."""
    levels = drive[[0, *turns, len(drive) - 1]]
    off = np.abs(np.column_stack([levels[2:-1] - levels[0], levels[3:] - levels[1]]))
    return bool(np.any(np.all(off < SAME_LEVEL * np.ptp(drive), axis=1)))

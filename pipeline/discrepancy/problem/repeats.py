"""Which cycles of a recording repeat each other, row by row."""

from dataclasses import replace

import numpy as np
from numba import njit

from pipeline.discrepancy.problem.problem import Problem

SAME_COMMAND, EXACTLY, REACH, ENOUGH_IN_COMMON = 1e-3, 1e-6, 6, 0.8


def repeated_cycles(problem: Problem, alone: bool = False) -> list[np.ndarray]:
    """Groups of training cycles with the same commands, each as row numbers (repeats, steps).

    alone: whether only the joint's own command has to be the same. Rows that a cycle lacks are -1,
    and so are the rows up to a cycle's first reversal where the cycle before was another motion or
    none: there the mechanism still remembers that.
    """
    rows_of, (signals, dwell) = rows_of_cycles(problem), driven(problem, alone)
    return [
        np.array([
            _without_memory(rows, group[0], rows_of.get(int(problem.cycle[rows.max()]) - 1),
                            signals, dwell)
            for rows in group
        ])
        for group in same_motions(problem, alone)
    ]  # fmt: skip


def same_motions(
    problem: Problem, alone: bool = False, within: float = SAME_COMMAND
) -> list[np.ndarray]:
    """The same with all rows that the cycles have in common, those before a first reversal too.

    within: by how much of their ranges the commands of a step may differ.
    """
    signals, dwell = driven(problem, alone)
    groups: list[list[np.ndarray]] = []
    for rows in rows_of_cycles(problem).values():
        if not problem.train[rows].any():
            continue
        for group in groups:
            same = repeating(signals, dwell, group[0], rows, within)
            if same is not None:
                group.append(same)
                break
        else:
            groups.append([rows])
    return [np.array(group) for group in groups if len(group) > 1]


def rows_of_cycles(problem: Problem) -> dict[int, np.ndarray]:
    """Row numbers of each cycle by its number."""
    return {int(c): np.flatnonzero(problem.cycle == c) for c in np.unique(problem.cycle)}


def driven(problem: Problem, alone: bool) -> tuple[np.ndarray, np.ndarray]:
    """All commands over their ranges, (n, k), and the time before each row [s], (n,).

    alone: the joint's own command alone.
    """
    motion = problem.motion
    others = [] if alone else motion.others.values()
    signals = np.column_stack([motion.drive, *others])
    signals /= np.maximum(np.ptp(signals, axis=0), 1e-12)
    return signals, np.diff(motion.time_s, prepend=motion.time_s[0])


def repeating(
    signals: np.ndarray, dwell: np.ndarray, first: np.ndarray, rows: np.ndarray,
    within: float = SAME_COMMAND,
) -> np.ndarray | None:  # fmt: skip
    """The row of a cycle (indices) for each row of the first one, -1 where it has none.

    None where the two are not the same motion within a part of their ranges. signals: (n, k)
    commands over these.
    """
    places = paired(signals[first], signals[rows], within)
    found = places >= 0
    if found.sum() < ENOUGH_IN_COMMON * max(len(first), len(rows)):
        return None
    out = np.where(found, rows[places], -1)
    apart = np.abs(dwell[first] - dwell[out])[found]
    return out if np.median(apart) < 0.3 * max(np.median(dwell), 1e-9) else None


@njit(cache=True)
def paired(first, second, within):  # type: ignore[no-untyped-def]
    """For each row of the first signals the next row of the second that equals it, -1 if none is.

    At most REACH rows of the second are passed over at a time.
    """
    out = np.full(first.shape[0], -1)
    begin = 0
    for i in range(first.shape[0]):
        for k in range(begin, min(begin + REACH, second.shape[0])):
            if np.max(np.abs(first[i] - second[k])) < within:
                out[i], begin = k, k + 1
                break
    return out


def _without_memory(
    rows: np.ndarray, first: np.ndarray, before: np.ndarray | None,
    signals: np.ndarray, dwell: np.ndarray,
) -> np.ndarray:  # fmt: skip
    """A cycle's rows, without those up to its first reversal after another motion."""
    if before is not None and repeating(signals, dwell, first, before) is not None:
        return rows
    drive = signals[first, 0]
    turn = min(int(np.argmax(np.abs(drive - drive[0]))), len(first) // 2)
    return np.where(np.arange(len(rows)) < turn, -1, rows)


def driven_again(problem: Problem) -> list[np.ndarray]:
    """The same of a force, whose cycles repeat only where its motion is one that was commanded.

    One that was measured never comes again to the sample. Held-out cycles are among them: of these
    nothing but their motion is looked at.
    """
    return same_motions(replace(problem, train=problem.train | problem.heldout), within=EXACTLY)

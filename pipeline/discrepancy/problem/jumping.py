"""A simulation that jumps with the direction: rigid friction about a static curve of a command."""

from collections.abc import Mapping
from itertools import pairwise

import numpy as np

from pipeline.discrepancy.problem.rough import noise_of_motion
from pipeline.physics.kinematics import SampledCurve, sampled_curve
from pipeline.recording import reversals_of

ON_BRANCH, BETWEEN, APART, STEPS, AT_ONCE = 2e-3, 0.15, 5e-3, 6.0, 0.5
FEWEST, LEAST_EACH, STEADY, FEW_OF_ALL = 40, 0.1, 0.9, 0.02
ROUNDS, KNOTS, FAR = 3, 60, 0.01
BESIDE, SLOW, FAST, CLEARLY, CREPT = 5, 0.02, 0.95, 6.0, 1e-4


def between_branches(
    commands: Mapping[str, np.ndarray], simulated: np.ndarray
) -> np.ndarray | None:
    """The middle (n,) of the two branches of a simulation (n,) over a command, None if none.

    There is one where the simulation is one static curve of a command while that rises, another
    while it falls, and changes from one to the other at once when it turns round: so does rigid
    friction, as of the capstan equation with the sign of the velocity. What slides over, as play
    and lags do, is none, nor is a jump of few steps, which these may be, too, or a loop that closes
    where it turns. Rows in which the command rests do not count, but to show what goes on there,
    as a lag does.
    """
    found = (middle_of(u, simulated) for u in commands.values())
    return next((middle for middle in found if middle is not None), None)


def middle_of(command: np.ndarray, simulated: np.ndarray) -> np.ndarray | None:
    """The middle (n,) of two branches of a simulation over a command, (n,) each; None if none."""
    rising, turns = rising_rows(command), reversals_of(command)
    moves = np.diff(simulated, prepend=simulated[:1])
    moving = np.abs(moves) > 0.0
    rows = np.flatnonzero(moving & going(command) & np.isfinite(simulated))
    if len(rows) < FEWEST or not len(turns):
        return None
    u, s, way = command[rows], simulated[rows], rising[rows]
    up = way
    for _ in range(ROUNDS):
        if not LEAST_EACH < np.mean(up) < 1.0 - LEAST_EACH:
            return None
        branches = [smooth_curve(u[b], s[b]) for b in (up, ~up)]
        off = np.array([np.abs(s - branch(u)) for branch in branches])
        up = off[0] < off[1]
    span, step = float(np.ptp(s)), float(np.median(np.abs(np.diff(s))))
    apart, jump = (np.abs(branches[0](v) - branches[1](v)) for v in (u, command[turns]))
    astray = int(np.sum(off.min(axis=0) > ON_BRANCH * span + BETWEEN * apart))
    astray += int(np.sum(left_behind(command, moving)))
    astray += int(np.sum(at_rest(command) & (np.abs(moves) > CREPT * span)))
    if astray > min(len(turns) + 1, FEW_OF_ALL * len(rows)):
        return None
    far = np.median(apart) > max(APART * span, STEPS * step)
    at_once = np.mean(jump) > AT_ONCE * np.median(apart)
    if not (far and at_once and np.mean(up == way) > STEADY):
        return None
    return np.asarray(0.5 * (branches[0](command) + branches[1](command)))


def smooth_curve(command: np.ndarray, simulated: np.ndarray) -> SampledCurve:
    """The curve through means of neighbouring commands: one that was measured has noise."""
    parts = np.array_split(np.argsort(command), min(KNOTS, len(command)))
    at, answer = ([float(v[part].mean()) for part in parts] for v in (command, simulated))
    return sampled_curve(np.array(at), np.array(answer))


def going(command: np.ndarray) -> np.ndarray:
    """Rows (n,) before and after which a command (n,) goes on, by more than its noise.

    At rest it has no direction, and where it comes to rest none that is sure.
    """
    padded = np.pad(command, BESIDE, mode="edge")
    before, after = padded[: -2 * BESIDE], padded[2 * BESIDE :]
    far = np.minimum(np.abs(command - before), np.abs(after - command))
    return np.asarray(
        far > max(SLOW * float(np.quantile(far, FAST)), CLEARLY * noise_of_motion(command))
    )


def at_rest(command: np.ndarray) -> np.ndarray:
    """Rows (n,) by which a command (n,) has been where it is for BESIDE rows."""
    rows = np.arange(len(command))
    moved = np.diff(command, prepend=command[:1]) != 0.0
    return np.asarray(rows - np.maximum.accumulate(np.where(moved, rows, -1)) > BESIDE)


def left_behind(command: np.ndarray, moving: np.ndarray) -> np.ndarray:
    """Rows (n,) in which a command (n,) has gone on since a simulation last moved, (n,)."""
    last = np.maximum.accumulate(np.where(moving, np.arange(len(moving)), 0))
    return np.asarray(np.abs(command - command[last]) > FAR * float(np.ptp(command)))


def rising_rows(command: np.ndarray) -> np.ndarray:
    """Rows (n,) in which a command goes on its way up, from one reversal to the next."""
    ends = np.r_[0, reversals_of(command), len(command) - 1]
    out = np.zeros(len(command), dtype=bool)
    for begin, end in pairwise(ends):
        out[begin : end + 1] = command[end] > command[begin]
    return out

"""Steps of an encoder or converter: their size, and what moved between two of them."""

from dataclasses import replace

import numpy as np
from scipy.linalg import solveh_banded
from scipy.optimize import minimize

from pipeline.discrepancy.problem.beside import may_follow
from pipeline.physics.even_grid import ON_GRID, quantum_of
from pipeline.physics.kinematics import Curve, sampled_curve
from pipeline.physics.motion import Motion
from pipeline.physics.play_operator import play

FEWEST_LEVELS = 10
OFTEN_EQUAL = 0.05
STIFFNESSES, FEW_OUTSIDE = 4.0 ** np.arange(16), 0.01
SECOND = (1.0, -2.0, 1.0)
LAGS, SHORTEST, STEPS = 2.0 ** np.arange(-2, 8), 1e-2, 60
PLAYS = np.array([0.0, 0.25, 0.5, 1.0, 2.0, 4.0])
NEARER, ALL_ALIKE = 0.9, 0.85


def between_counts(counted: np.ndarray, quantum: float) -> np.ndarray:
    """The smoothest motion (n,) of which an encoder of step `quantum` counts `counted` (n,).

    It is within half a step of all but one in a hundred counts, and moved there at those. Source:
    Whittaker's smoother (Eilers, Anal. Chem. 75 (2003) 3631) with second differences.
    """
    best = counted
    for stiffness in STIFFNESSES:
        smooth = whittaker(counted, stiffness)
        if np.mean(np.abs(smooth - counted) > 0.5 * quantum) > FEW_OUTSIDE:
            break
        best = smooth
    return np.clip(best, counted - 0.5 * quantum, counted + 0.5 * quantum)


def whittaker(values: np.ndarray, stiffness: float) -> np.ndarray:
    """z (n,) that makes |values - z|^2 + stiffness |second differences of z|^2 least."""
    bands = np.zeros((3, len(values)))
    for i, a in enumerate(SECOND):
        for j in range(i, 3):
            bands[2 - (j - i), j : len(values) - 2 + j] += stiffness * a * SECOND[j]
    bands[2] += 1.0
    return np.asarray(solveh_banded(bands, values))


def smooth_motion(counted: np.ndarray, measured: np.ndarray) -> tuple[np.ndarray, float]:
    """What surely moved smoothly behind the counts of an encoder (n,), and its step; or the counts.

    measured: (n,), NaN where not measured. It tells an encoder that counts what moves, from a motor
    that goes in steps: then the measurement goes in the same steps, at once or some rows later, or
    is nearer to them behind some lag and play than to the smooth motion behind any. So do counts
    that each stay for as many rows. The step is 0.0 where the command is left as it is.
    """
    quantum = quantum_of(counted)
    few = float(np.ptp(counted)) < FEWEST_LEVELS * quantum
    if quantum == 0.0 or few or np.mean(np.diff(counted) == 0.0) < OFTEN_EQUAL:
        return counted, 0.0
    if stairs(counted):
        return counted, 0.0
    smooth = between_counts(counted, quantum)
    followed = may_follow(counted - smooth, smooth, measured) or (
        left_behind_lag(counted, measured, quantum)
        < NEARER * left_behind_lag(smooth, measured, quantum)
    )
    return (counted, 0.0) if followed else (smooth, quantum)


def stairs(values: np.ndarray) -> bool:
    """Whether nearly each of values (n,) stays for the same number of rows, as one commanded does.

    A motion that is counted would have to go at one speed, and that in whole rows a count.
    """
    stays = np.diff(np.flatnonzero(np.diff(values, prepend=np.nan) != 0.0))
    return bool(len(stays) and np.mean(stays == np.median(stays)) > ALL_ALIKE)


def left_behind_lag(drive: np.ndarray, measured: np.ndarray, quantum: float) -> float:
    """Least root mean square that a line in a drive (n,) behind play and lag leaves of measured.

    measured: (n,), NaN where not measured. The lag is of first order, or two alike one behind the
    other. The best of a grid of plays [quanta] and lags [rows] is refined.
    """
    from scipy.signal import lfilter  # 0.4 s: only encoders wait for it

    rows, moved = np.isfinite(measured), drive - float(drive[0])

    def left(sizes: np.ndarray, twice: bool) -> float:
        late = play(moved, 0.5 * quantum * abs(sizes[0]), 0.0)
        fade = float(np.exp(-1.0 / max(abs(sizes[1]), SHORTEST)))
        for _ in range(1 + twice):
            late = lfilter([1.0 - fade], [1.0, -fade], late)
        line = np.polyval(np.polyfit(late[rows], measured[rows], 1), late[rows])
        return float(np.sqrt(np.mean((measured[rows] - line) ** 2)))

    plays = PLAYS[PLAYS * quantum < 0.5 * np.ptp(drive)]
    grid = [(np.array([p, lag]), twice) for p in plays for lag in LAGS for twice in (False, True)]
    best, twice = min(grid, key=lambda at: left(*at))
    return float(minimize(left, best, (twice,), "Nelder-Mead", options={"maxiter": STEPS}).fun)


def uncounted(
    motion: Motion, curve: Curve, measured: np.ndarray, simulated: np.ndarray
) -> tuple[Motion, Curve, float]:
    """A motion and its curve with what moved behind the drive's counts, and their step; or as is.

    The curve goes through the counts where the simulation (n,) was reckoned from them.
    """
    smooth, quantum = smooth_motion(motion.drive, measured)
    known = np.isfinite(simulated)
    if quantum > 0.0 and not reckoned_from(motion.drive[known], simulated[known]):
        curve = sampled_curve(smooth[known], simulated[known])
    return replace(motion, drive=smooth), curve, quantum


def reckoned_from(counted: np.ndarray, simulated: np.ndarray) -> bool:
    """Whether a simulation (n,) says the same wherever a count (n,) is the same."""
    order = np.argsort(counted, kind="stable")
    same = np.diff(counted[order]) == 0.0
    apart = np.abs(np.diff(simulated[order]))[same]
    return bool(np.all(apart < ON_GRID * max(float(np.ptp(simulated)), 1e-300)))


def between_known_counts(values: np.ndarray, quantum: float) -> np.ndarray:
    """The smooth motion behind values (n,), if they are counts in steps of `quantum`; or they."""
    counts = quantum > 0.0 and abs(quantum_of(values) - quantum) < ON_GRID * quantum
    return between_counts(values, quantum) if counts else values

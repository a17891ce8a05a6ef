"""A command that is held through each dwell or runs on, and what follows it late."""

import numpy as np
from numba import njit

from pipeline.physics.motion import Motion
from pipeline.physics.term import Parameter, Surroundings

STEP_AND_WAIT_S = 1.0  # a robot that is sampled no more often steps and waits
DENSE = 200
LAGS = (0.3, 0.7, 1.5, 4.0)
UNEVEN, UNEVEN_WAITS = 0.05, 0.005


def dwells(motion: Motion, last_time: float) -> np.ndarray:
    """Time that each command had before its sample was taken, (n,) [s]."""
    if last_time == motion.time_s[0]:
        return motion.dwell_s
    return np.diff(motion.time_s, prepend=last_time)


def uneven(time_s: np.ndarray) -> bool:
    """Whether samples (n,) follow each other so unevenly that counting them is no clock.

    Of a robot that steps and waits a little is enough: a pose that is held longer is older.
    """
    gaps = np.diff(time_s)
    waits = len(gaps) > 0 and np.median(gaps) >= STEP_AND_WAIT_S
    return bool(np.std(gaps) > (UNEVEN_WAITS if waits else UNEVEN) * np.mean(gaps))


def usual_lag_s(around: Surroundings) -> float:
    """A lag that is usual: a dwell, or a small part of a cycle that is sampled densely [s]."""
    return max(around.dwell_s, around.period_s / DENSE, 1e-9)


def usual_lags_s(around: Surroundings) -> list[float]:
    """Lags to begin a search from, the shortest first [s]."""
    units = max(around.dwell_s, 1e-9), usual_lag_s(around)
    return sorted({k * unit for k in LAGS for unit in units})


def longest_lag_s(around: Surroundings) -> float:
    """The longest lag that is one: thirty dwells, or a seventh of a cycle [s]."""
    return max(30.0 * max(around.dwell_s, 1e-9), 0.15 * around.period_s)


def lag_parameter(around: Surroundings) -> Parameter:
    """The time constant of a lag [s]."""
    usual = usual_lag_s(around)
    return Parameter("time_constant", "s", 0.0, longest_lag_s(around), usual, usual)


@njit(cache=True)
def slewed(signal, dwell, time_constant, top_speed, at, falling=1.0):  # type: ignore[no-untyped-def]
    """x' = (u - x) / time_constant, at most top_speed, u held: exact answer (n,).

    falling: by how many times it may fall faster than it rises.
    """
    out = np.empty(signal.size)
    for i in range(signal.size):
        left, way = dwell[i], signal[i] - at
        most = top_speed if way > 0.0 else falling * top_speed
        beyond = abs(way) - most * time_constant
        if beyond > 0.0:
            running = min(left, beyond / most)
            at += np.sign(way) * most * running
            left -= running
        if left > 0.0:
            fade = np.exp(-left / time_constant) if time_constant > 0.0 else 0.0
            at = signal[i] - (signal[i] - at) * fade
        out[i] = at
    return out


def followed(
    signal: np.ndarray, motion: Motion, late_s: float, top_speed: float, state: np.ndarray | None
) -> tuple[np.ndarray, np.ndarray]:
    """What follows a held signal (n,) so, (n,), and the last time [s] and answer to go on from."""
    last_s, at = (motion.time_s[0], signal[0]) if state is None else state
    dwell, asked = dwells(motion, float(last_s)), np.ascontiguousarray(signal)
    out = slewed(asked, dwell, late_s, top_speed, float(at))
    return out, np.array([motion.time_s[-1], out[-1]])


@njit(cache=True)
def trailed(signal, dwell, time_constant, moving, before, at):  # type: ignore[no-untyped-def]
    """x' = (u - x) / time_constant: exact answer (n,).

    Over the share `moving` of each dwell the command u runs straight to its next value, then it is
    held there. before, at: the command and the answer ahead of the first sample.
    """
    out = np.empty(signal.size)
    for i in range(signal.size):
        runs = moving * dwell[i]
        if runs > 0.0:
            late = (signal[i] - before) / runs * time_constant
            fade = np.exp(-runs / time_constant) if time_constant > 0.0 else 0.0
            at = signal[i] - late + (at - before + late) * fade
        if dwell[i] > runs:
            fade = np.exp((runs - dwell[i]) / time_constant) if time_constant > 0.0 else 0.0
            at = signal[i] + (at - signal[i]) * fade
        before = signal[i]
        out[i] = at
    return out

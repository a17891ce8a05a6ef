"""A command that is held through each dwell or runs on, and what follows it late."""

import numpy as np
from numba import njit

from pipeline.physics.motion import Motion

STEP_AND_WAIT_S = 0.5  # a robot that is sampled no more often steps and waits


def dwells(motion: Motion, last_time: float) -> np.ndarray:
    """Time that each command had before its sample was taken, (n,) [s]."""
    return np.diff(motion.time_s, prepend=last_time)


@njit(cache=True)
def slewed(signal, dwell, time_constant, top_speed, at):  # type: ignore[no-untyped-def]
    """x' = (u - x) / time_constant, at most top_speed either way, u held: exact answer (n,)."""
    out = np.empty(signal.size)
    for i in range(signal.size):
        left, way = dwell[i], signal[i] - at
        beyond = abs(way) - top_speed * time_constant
        if beyond > 0.0:
            running = min(left, beyond / top_speed)
            at += np.sign(way) * top_speed * running
            left -= running
        if left > 0.0:
            fade = np.exp(-left / time_constant) if time_constant > 0.0 else 0.0
            at = signal[i] - (signal[i] - at) * fade
        out[i] = at
    return out


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

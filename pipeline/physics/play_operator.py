"""The play operator: what is pushed by one end of a gap or by the other, and else stays."""

import numpy as np
from numba import njit


@njit(cache=True)
def play(drive: np.ndarray, half_width: float, start: float) -> np.ndarray:
    """The play operator: the output moves only when it is pushed by an end of the gap."""
    out = np.empty(drive.size)
    at = start
    for i in range(drive.size):
        if drive[i] - half_width > at:
            at = drive[i] - half_width
        elif drive[i] + half_width < at:
            at = drive[i] + half_width
        out[i] = at
    return out


@njit(cache=True)
def varying_play(drive, half_width, at):  # type: ignore[no-untyped-def]
    """The play operator, (n,), with a gap of its own for each sample."""
    out = np.empty(drive.size)
    for i in range(drive.size):
        half = half_width[i]
        at = max(at, drive[i] - half) if drive[i] - half > at else min(at, drive[i] + half)
        out[i] = at
    return out

"""A bristle that bends and slides behind a dashpot: a magnetorheological damper's fluid."""

import numpy as np
from numba import njit

STEPS, ROUNDS, CLOSE = 2, 40, 1e-9


@njit(cache=True, error_model="numpy")
def _share_after(share, fast, onset, part):  # type: ignore[no-untyped-def]
    """The root z of z - share = part (fast - onset z) (1 - z^2, or 1 where z falls back)."""
    low, high, z = -1.0, 1.0, share
    for _ in range(ROUNDS):
        bend = fast - onset * z
        loads = bend * z > 0.0
        gives = 1.0 - z * z if loads else 1.0
        missed = z - share - part * bend * gives
        if missed > 0.0:
            high = z
        else:
            low = z
        slope = 1.0 + part * onset * gives + (2.0 * part * bend * z if loads else 0.0)
        after = z - missed / slope
        if not low < after < high:
            after = 0.5 * (low + high)
        if abs(after - z) < CLOSE:
            return after
        z = after
    return z


@njit(cache=True, error_model="numpy")
def _yielded(velocity, time_s, onset, reach, before, then_s, share):  # type: ignore[no-untyped-def]
    out = np.empty(velocity.size)
    for i in range(velocity.size):
        part = (time_s[i] - then_s) / STEPS / reach
        for k in range(STEPS):
            fast = before + (velocity[i] - before) * (k + 1.0) / STEPS
            share = _share_after(share, fast, onset, part)
        before, then_s = velocity[i], time_s[i]
        out[i] = share
    return out


def yielding(
    velocity: np.ndarray, time_s: np.ndarray, onset: float, reach: float, state: np.ndarray | None
) -> tuple[np.ndarray, np.ndarray]:
    """Share of the friction that acts, (n,) from -1 to 1, and the state to carry.

    A dashpot that the whole friction moves at the speed `onset` [x'], and behind it a bristle that
    gives way over `reach` [x] as Bouc and Wen's does with the exponent 2:
    z' = (x' - onset z) (1 - z^2) / reach where z grows, (x' - onset z) / reach where it falls back.
    Slow motion is the dashpot's alone, z = x' / onset, up to a sharp knee at `onset`. Euler's
    method backwards, STEPS a sample, each with Newton's between two bounds. Source: Spencer, Dyke,
    Sain and Carlson, J. Eng. Mech. 123 (1997) 230 (the force is that of their dashpot c1).
    """
    begun = np.array([velocity[0], time_s[0], 0.0]) if state is None else state
    out = _yielded(np.ascontiguousarray(velocity), time_s, onset, reach, *begun)
    return out, np.array([velocity[-1], time_s[-1], out[-1]])

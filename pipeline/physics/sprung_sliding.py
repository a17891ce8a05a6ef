"""A slider that resists by its speed, behind a spring: dry contact that gives before it slides."""

import numpy as np
from numba import njit

STEPS, ROUNDS, CLOSE = 2, 20, 1e-7
LEAST_SHARE = 1e-9


@njit(cache=True, error_model="numpy")
def _given_way(velocity, time_s, onset, reach, before, then_s, share):  # type: ignore[no-untyped-def]
    out = np.empty(velocity.size)
    for i in range(velocity.size):
        step_s = (time_s[i] - then_s) / STEPS
        slip = max(onset * step_s / reach, LEAST_SHARE)
        for k in range(STEPS):
            fast = before + (velocity[i] - before) * (k + 1.0) / STEPS
            wanted = share + fast * step_s / reach
            side, far = (1.0, wanted) if wanted >= 0.0 else (-1.0, -wanted)
            speed = max(far / (1.0 + slip), (far - 1.0) / slip)
            for _ in range(ROUNDS):
                held = np.tanh(speed)
                change = (far - held - slip * speed) / (1.0 - held * held + slip)
                speed += change
                if abs(change) < CLOSE * (1.0 + speed):
                    break
            share = side * np.tanh(speed)
        before, then_s = velocity[i], time_s[i]
        out[i] = share
    return out


def giving_way(
    velocity: np.ndarray, time_s: np.ndarray, onset: float, reach: float, state: np.ndarray | None
) -> tuple[np.ndarray, np.ndarray]:
    """Share of the friction that acts, (n,) from -1 to 1, and the state to carry.

    A spring that the friction stretches by `reach` [its unit], and behind it a slider that
    resists by z = tanh(its speed / onset): z' = (x' - onset atanh z) / reach. `reach` near 0 is
    tanh(x' / onset), `onset` near 0 a slider that is stuck or slides. So do magnetorheological
    fluids, which give before they yield. Euler's method backwards, STEPS a sample, each with
    Newton's from below, where it converges. Source: Kamath, Hurt and Wereley, Smart Mater. Struct.
    5 (1996) 576 (viscoelastic-plastic model).
    """
    begun = np.array([velocity[0], time_s[0], 0.0]) if state is None else state
    out = _given_way(np.ascontiguousarray(velocity), time_s, onset, reach, *begun)
    return out, np.array([velocity[-1], time_s[-1], out[-1]])

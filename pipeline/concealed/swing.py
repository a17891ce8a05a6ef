"""A heavy tip on a springy end: it swings after the joint, and lags it."""

import numpy as np
from numba import njit

STEPS_A_RADIAN = 20.0


@njit(cache=True)
def tip_deg(joint_deg: np.ndarray, interval_s: np.ndarray, move_s: float, swing_s: float,
            damping: float) -> np.ndarray:  # fmt: skip
    """Angle of the tip [deg] at the end of each interval, shape (n,).

    x'' = (u - x) / swing_s^2 - 2 damping / swing_s x', in steps of Runge and Kutta. The joint u
    runs straight to its next angle in the first `move_s` of each interval [s] (n,), then waits.
    """
    out = np.empty(len(joint_deg))
    x, v, before = joint_deg[0], 0.0, joint_deg[0]
    for i in range(len(joint_deg)):
        moving = min(move_s, interval_s[i])
        speed = (joint_deg[i] - before) / moving if moving > 0.0 else 0.0
        for part in range(2):
            span = moving if part == 0 else interval_s[i] - moving
            steps = int(np.ceil(span / swing_s * STEPS_A_RADIAN))
            for k in range(steps):
                h = span / steps
                u = before + speed * k * h if part == 0 else joint_deg[i]
                x, v = stepped(x, v, u, speed if part == 0 else 0.0, h, swing_s, damping)
        before = joint_deg[i]
        out[i] = x
    return out


@njit(cache=True)
def stepped(x: float, v: float, u: float, speed: float, h: float, swing_s: float,
            damping: float) -> tuple[float, float]:  # fmt: skip
    """Angle and speed of the tip a time `h` later, u being where the joint is and `speed` its."""
    dx, dv, sum_x, sum_v = 0.0, 0.0, 0.0, 0.0
    for part, weight in ((0.0, 1.0), (0.5, 2.0), (0.5, 2.0), (1.0, 1.0)):
        at, pace, asked = x + part * h * dx, v + part * h * dv, u + part * h * speed
        dx, dv = pace, (asked - at) / swing_s**2 - 2.0 * damping / swing_s * pace
        sum_x += weight * dx
        sum_v += weight * dv
    return x + h / 6.0 * sum_x, v + h / 6.0 * sum_v

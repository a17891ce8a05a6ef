"""A load that play and a spring drive: it swings where teeth meet, and is thrown back."""

import numpy as np
from numba import njit

FEWEST, MOST, FINE = 4, 40, 0.25


@njit(cache=True, error_model="numpy")
def thrown(drive, dwell, values, state):  # type: ignore[no-untyped-def]
    """Where the load is, (n,), and where the drive, load and the load's speed are at last, (3,).

    values: width, drag, fading, natural_frequency, damping, of
    q'' = push - drag sgn(q') - fading q', push = w0^2 d + 2 damping w0 (u' - q'), d being how far
    the drive u is ahead of the load q beyond the half gap; no push is a pull, and in the gap there
    is none. Between two samples the drive runs straight, in parts that are short beside the
    spring's swing. Source: Nordin and Gutman, Automatica 38 (2002) 1633 (two masses, a shaft of
    finite stiffness, a dead zone).
    """
    out = np.empty(drive.size)
    before, at, speed = state
    width, drag, fading, frequency, damping = values
    half_width, stiff, resists = 0.5 * width, frequency * frequency, 2.0 * damping * frequency
    for i in range(drive.size):
        parts = min(max(int(np.ceil(frequency * dwell[i] / FINE)), FEWEST), MOST)
        part = dwell[i] / parts
        if part > 0.0:
            pace, kept, slowed = (drive[i] - before) / dwell[i], np.exp(-fading * part), drag * part
            for k in range(parts):
                ahead = before + (drive[i] - before) * k / parts - at
                push = 0.0
                if ahead > half_width:
                    push = max(stiff * (ahead - half_width) + resists * (pace - speed), 0.0)
                elif ahead < -half_width:
                    push = min(stiff * (ahead + half_width) + resists * (pace - speed), 0.0)
                speed = kept * (speed + part * push)
                speed = np.sign(speed) * max(abs(speed) - slowed, 0.0)
                at += speed * part
        before = drive[i]
        out[i] = at
    return out, np.array([before, at, speed])

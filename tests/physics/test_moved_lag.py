"""A lag behind moves of a steady speed."""

import numpy as np
from scipy.integrate import solve_ivp

from pipeline.physics.motion import Motion
from pipeline.physics.moved_lag import MovedLag
from tests.discrepancy.made import diagnosed_beside_its_commands, names, strokes

RNG = np.random.default_rng(4)
SPEED, W, DAMPING = 4.0, 2.5, 0.8


def moves(count: int) -> Motion:
    """Steps of many sizes, each followed by a wait of its own."""
    drive = strokes(RNG.uniform(15.0, 45.0, count) * (-1.0) ** np.arange(count), 20)
    moving_s = np.abs(np.diff(drive, prepend=drive[0])) / SPEED
    time_s = np.cumsum(moving_s + RNG.choice([0.4, 1.0, 3.0], len(drive)))
    return Motion(drive, time_s, np.zeros(len(drive), dtype=int))


def seen(motion: Motion) -> np.ndarray:
    """What swings after a command that goes at SPEED, then waits; integrated in time."""
    u, t = motion.drive, motion.time_s
    state, out = [u[0], 0.0], [u[0]]
    for k in range(1, len(u)):

        def asked(s: float, k: int = k) -> float:
            return u[k - 1] + np.clip(u[k] - u[k - 1], -SPEED * s, SPEED * s)

        def slope(s: float, y: np.ndarray, asked=asked) -> list[float]:
            return [y[1], W * W * (asked(s) - y[0]) - 2.0 * DAMPING * W * y[1]]

        found = solve_ivp(slope, (0.0, t[k] - t[k - 1]), state, rtol=1e-7, max_step=0.1)
        state = [float(y) for y in found.y[:, -1]]
        out.append(state[0])
    return np.array(out)


def test_it_follows_its_equation_whole_or_in_blocks():
    motion, values = moves(6), np.array([W, DAMPING, SPEED])
    expected, lag = seen(motion), MovedLag()
    np.testing.assert_allclose(
        lag.respond(motion.drive, motion, values, None)[0], expected, atol=1e-4
    )
    first, last = (motion.rows(rows) for rows in np.split(np.arange(len(motion)), [50]))
    out, state = lag.respond(first.drive, first, values, None)
    rest = lag.respond(last.drive, last, values, state)[0]
    np.testing.assert_allclose(np.concatenate([out, rest]), expected, atol=1e-4)


def test_a_robot_that_moves_at_its_speed_and_waits_is_late_by_one_lag():
    motion = moves(50)
    noise = 0.15 * RNG.standard_normal(len(motion))
    result = diagnosed_beside_its_commands(motion, seen(motion) + noise)
    assert names(result) == {"response_lag"}
    assert result.diagnoses[0].after.heldout_rmse < 1.1 * 0.15

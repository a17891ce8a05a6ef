"""A servo that hears of its command late and has a top speed, each way its own."""

import numpy as np
import pytest

from tests.discrepancy.made import diagnosed, followed, names, value_of
from tests.discrepancy.test_too_many import servo

FORTH, BACK, DEAD_S = 220.0, 300.0, 0.06


def swept(time_s: np.ndarray) -> np.ndarray:
    """Ever faster to and fro: at first within the servo's speed, then beyond it."""
    return 60.0 * np.sin(2.0 * np.pi * (0.2 * time_s + 0.06 * time_s**2))


def slow(time_s: np.ndarray) -> np.ndarray:
    """The same, within its speed."""
    return 15.0 * np.sin(2.0 * np.pi * (0.2 * time_s + 0.06 * time_s**2))


@pytest.mark.parametrize("seed", [1, 2])
def test_dead_time_and_top_speeds_are_found_of_a_servo_at_its_limits(seed):
    time_s = 0.02 * np.arange(700)
    seen = servo(time_s, swept, DEAD_S, FORTH, BACK)
    seen = seen + 0.3 * np.random.default_rng(seed).standard_normal(len(seen))
    result = diagnosed(followed(time_s, swept(time_s), seen, 0.5))
    (found,) = result.diagnoses
    assert names(result) == {"response_lag"}
    assert found.physics[0].alternatives[0] in {"frame_lag", "creep"}
    assert value_of(result, "response_lag", "top_speed").value == pytest.approx(FORTH, rel=0.05)
    falling = value_of(result, "response_lag", "falling").value
    assert falling == pytest.approx(BACK / FORTH, rel=0.05)
    assert value_of(result, "response_lag", "dead_time").value == pytest.approx(DEAD_S, abs=0.012)
    assert found.after.heldout_rmse < 0.02 * found.before.heldout_rmse


def test_dead_time_before_a_lag_is_a_lag_or_an_old_frame():
    time_s, fine_s = 0.02 * np.arange(700), 1e-3
    ticks_s = np.arange(-1.0, time_s[-1] + fine_s, fine_s)
    course = [0.0]
    for target in slow(ticks_s - DEAD_S)[1:]:
        course.append(course[-1] + fine_s / 0.09 * (target - course[-1]))
    seen = np.interp(time_s, ticks_s, course)
    seen = seen + 0.05 * np.random.default_rng(4).standard_normal(len(seen))
    result = diagnosed(followed(time_s, slow(time_s), seen, 0.5))
    assert names(result) == {"response_lag"}
    assert "frame_lag" in result.diagnoses[0].physics[0].alternatives
    assert value_of(result, "response_lag", "dead_time").value == pytest.approx(DEAD_S, abs=0.015)
    assert value_of(result, "response_lag", "time_constant").value == pytest.approx(0.09, rel=0.15)

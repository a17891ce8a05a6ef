import numpy as np
import pytest

from pipeline.config import AxisTwin, TwinConfig
from pipeline.physics.motion import Motion
from pipeline.physics.term import TermError
from pipeline.twin.snake import Snake, physics_of

PLAIN = AxisTwin(gain=0.8, cubic=1e-5, play_half_width_deg=2.0)


def poses(snake: Snake, axis: str, shafts_deg: np.ndarray) -> np.ndarray:
    found = []
    for step, shaft in enumerate(shafts_deg):
        snake.move(3.0 * (step + 1), {"yaw": 0.0, "pitch": 0.0, axis: shaft})
        found.append(snake.pose_deg()[axis])
    return np.array(found)


def there_and_back(top: float, bottom: float) -> np.ndarray:
    return np.concatenate([np.linspace(0, top, 26), np.linspace(top, bottom, 51)[1:]])


def test_a_joint_takes_the_curve_after_its_play():
    snake = Snake(TwinConfig(yaw=PLAIN), seed=0)
    angle_deg = poses(snake, "yaw", np.array([30.0, 28.0, 26.0, 20.0]))
    behind = np.array([28.0, 28.0, 28.0, 22.0])
    np.testing.assert_allclose(angle_deg, 0.8 * behind - 1e-5 * behind**3)


def test_step_by_step_is_as_all_at_once():
    shafts = there_and_back(60.0, -60.0)
    stepwise = poses(Snake(TwinConfig(pitch=PLAIN), seed=0), "pitch", shafts)
    motion = Motion(shafts, 3.0 * np.arange(1, len(shafts) + 1), np.zeros(len(shafts), int))
    np.testing.assert_allclose(stepwise, physics_of("pitch", PLAIN).body.respond(motion)[0])


def test_noise_is_the_robots_own():
    snake = Snake(TwinConfig(yaw=AxisTwin(noise_deg=0.4)), seed=1)
    snake.move(1.0, {"yaw": 10.0, "pitch": 0.0})
    standing = snake.pose_deg()
    snake.move(9.0, {"yaw": 10.0, "pitch": 0.0})
    assert snake.pose_deg() == standing
    snake.move(12.0, {"yaw": 11.0, "pitch": 0.0})
    assert snake.pose_deg() != standing
    assert standing["pitch"] == 0.0


def test_noise_has_the_deviation_that_it_is_given_and_follows_the_seed():
    config = TwinConfig(yaw=AxisTwin(noise_deg=0.4))
    shafts = np.tile([5.0, 5.5], 1000)
    first, again, other = (poses(Snake(config, seed), "yaw", shafts) for seed in (3, 3, 4))
    np.testing.assert_array_equal(first, again)
    assert not np.allclose(first, other)
    still = poses(Snake(TwinConfig(), 0), "yaw", shafts)
    assert np.std(first - still) == pytest.approx(0.4, rel=0.08)
    assert np.mean(first - still) == pytest.approx(0.0, abs=0.04)
    assert abs(np.corrcoef((first - still)[1:], (first - still)[:-1])[0, 1]) < 0.08


def test_further_terms_are_added_by_name():
    config = AxisTwin(terms={"friction": {}})
    plain = poses(Snake(TwinConfig(), 0), "yaw", there_and_back(40.0, -40.0))
    rubbing = poses(Snake(TwinConfig(yaw=config), 0), "yaw", there_and_back(40.0, -40.0))
    assert np.abs(rubbing - plain).max() > 0.1


def test_the_other_axis_can_move_this_one():
    config = AxisTwin(terms={"coupling/pitch_command_deg": {"gain": 0.1}})
    snake = Snake(TwinConfig(yaw=config), 0)
    snake.move(1.0, {"yaw": 0.0, "pitch": 20.0})
    pulled_deg = 2.0 / config.gain
    bent_deg = config.gain * pulled_deg - config.cubic * pulled_deg**3
    assert snake.pose_deg()["yaw"] == pytest.approx(bent_deg)


def test_what_the_camera_gets_wrong_is_seen_but_not_true():
    config = AxisTwin(terms={"drift/linear": {"rate": 10.0}})
    snake = Snake(TwinConfig(yaw=config), 0)
    snake.move(1800.0, {"yaw": 10.0, "pitch": 0.0})
    assert snake.pose_deg()["yaw"] == pytest.approx(8.0 - 0.01)
    assert snake.seen_deg()["yaw"] == pytest.approx(13.0 - 0.01)
    assert snake.seen_deg()["pitch"] == snake.pose_deg()["pitch"]


def test_two_looks_at_one_moment_are_one():
    terms = {"marker_outliers": {"share": 0.2, "size": 9.0}}  # draws by counting what it is shown
    once, twice = (Snake(TwinConfig(yaw=AxisTwin(terms=terms)), 0) for _ in range(2))
    seen = {1: [], 2: []}
    for step, shaft in enumerate(there_and_back(40.0, -40.0), start=1):
        for snake, looks in ((once, 1), (twice, 2)):
            for _ in range(looks):
                snake.move(3.0 * step, {"yaw": shaft, "pitch": 0.0})
            seen[looks].append(snake.seen_deg()["yaw"])
    assert seen[1] == seen[2]
    assert np.abs(np.diff(seen[1])).max() > 5.0


def test_unknown_terms_are_refused():
    with pytest.raises(TermError, match="magic"):
        Snake(TwinConfig(yaw=AxisTwin(terms={"magic": {}})), 0)
    with pytest.raises(TermError, match="depth"):
        Snake(TwinConfig(yaw=AxisTwin(terms={"friction": {"depth": 1.0}})), 0)

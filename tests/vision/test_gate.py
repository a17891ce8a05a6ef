import numpy as np
import pytest

from pipeline.vision.gate import flag_outliers


def track(noise_deg: float, seed: int = 0) -> np.ndarray:
    """Two cycles of a triangle with a play of 2 deg to either side."""
    command = np.concatenate([np.linspace(0, 45, 50), np.linspace(45, -45, 100)] * 2)
    at, angles = 0.0, []
    for value in command:
        at = min(max(at, value - 2.0), value + 2.0)
        angles.append(at)
    return np.array(angles) + noise_deg * np.random.default_rng(seed).standard_normal(len(command))


@pytest.mark.parametrize("noise_deg", [0.0, 0.1, 0.45])
@pytest.mark.parametrize("seed", range(5))
def test_reversals_and_play_are_no_outliers(noise_deg, seed):
    angle_deg = track(noise_deg, seed)[:150]
    assert not flag_outliers(angle_deg, 5.0).any()


@pytest.mark.parametrize("noise_deg", [0.02, 0.45])
def test_single_and_paired_outliers_are_flagged_and_nothing_is_changed(noise_deg):
    angle_deg = track(noise_deg)[:150]
    for row in (30, 70, 71):
        angle_deg[row] += 25.0
    before = angle_deg.copy()
    assert np.flatnonzero(flag_outliers(angle_deg, 5.0)).tolist() == [30, 70, 71]
    np.testing.assert_array_equal(angle_deg, before)


def test_a_lasting_jump_is_believed_and_does_not_lock_the_gate():
    angle_deg = track(0.1)[:150]
    angle_deg[60:] += 40.0
    angle_deg[100] -= 30.0
    assert np.flatnonzero(flag_outliers(angle_deg, 5.0)).tolist() == [100]


def test_wild_values_that_agree_with_nothing_stay_flagged():
    angle_deg = track(0.1)[:150]
    angle_deg[60:66] = [170.0, -100.0, 90.0, -170.0, 120.0, -60.0]
    assert np.flatnonzero(flag_outliers(angle_deg, 5.0)).tolist() == list(range(60, 66))


def test_where_the_command_goes_far_the_angle_may_too():
    ways = np.concatenate([np.full(60, 0.5), [6.0, 6.0, -6.0, 0.0, 0.0, -12.0], np.full(60, -0.5)])
    command_deg = np.cumsum(ways)
    angle_deg = command_deg + 0.1 * np.random.default_rng(1).standard_normal(len(ways))
    angle_deg[[30, 100]] += 25.0
    assert len(np.flatnonzero(flag_outliers(angle_deg, 5.0))) > 2
    assert np.flatnonzero(flag_outliers(angle_deg, 5.0, command_deg)).tolist() == [30, 100]


def test_missing_values_are_neither_flagged_nor_poison_the_filter():
    angle_deg = track(0.1)[:150]
    angle_deg[[0, 1, 40, 41, 42, 43, 44, 149]] = np.nan
    angle_deg[90] += 20.0
    assert np.flatnonzero(flag_outliers(angle_deg, 5.0)).tolist() == [90]
    assert not flag_outliers(np.full(10, np.nan), 5.0).any()
    assert flag_outliers(np.zeros(0), 5.0).shape == (0,)

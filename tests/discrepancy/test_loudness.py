"""Noise that is louder at the ends of the range than at home is no mistaken frames."""

import numpy as np
import pytest

from pipeline.discrepancy.judgement.loudness import loud_note, loudness
from tests.discrepancy.made import ANGLE, SIMULATED, changed, diagnosed, names, recorded

ROWS = 1200
ANGLES = 40.0 * np.sin(np.arange(ROWS) / 30.0)
EVERY = np.ones(ROWS, dtype=bool)


def errors(growing: float) -> np.ndarray:
    """Noise of 0.1 at home that grows by a share for each 40 deg."""
    size = 0.1 * (1.0 + growing * np.abs(ANGLES) / 40.0)
    return size * np.random.default_rng(3).standard_normal(ROWS)


def test_noise_of_one_size_is_nowhere_louder():
    assert np.all(loudness(errors(0.0), ANGLES, EVERY) == 1.0)
    assert loud_note(errors(0.0), ANGLES, EVERY, "deg") == []


def test_noise_that_grows_with_the_angle_is_louder_at_the_ends():
    louder = loudness(errors(4.0), ANGLES, EVERY)
    assert louder[np.abs(ANGLES) > 39.0].min() > 1.25
    assert np.all(louder[np.abs(ANGLES) < 10.0] == 1.0)


def test_few_mistaken_rows_and_rows_not_measured_move_nothing():
    off = errors(0.0)
    off[::50] += 5.0
    off[7::60] = np.nan
    assert np.all(loudness(off, ANGLES, EVERY) == 1.0)


def test_of_few_rows_nothing_is_said():
    few = np.arange(ROWS) < 100
    assert np.all(loudness(errors(4.0), ANGLES, few) == 1.0)


def test_a_joint_that_mostly_stands_still_has_no_usual_noise():
    standing = np.where(np.abs(ANGLES) < 30.0, 1e-5, 1.0) * errors(0.0)
    assert loudness(standing, ANGLES, EVERY).max() > 100.0
    assert loud_note(standing, ANGLES, EVERY, "deg") == []


@pytest.mark.parametrize("seed", [3, 4])
def test_a_sensor_that_is_noisy_at_the_ends_mistakes_no_frames(seed):
    recording = recorded({}, seed=seed, cycles=9, noise=0.1)
    simulated = recording.values(SIMULATED)
    more = 0.4 * (np.abs(simulated) / np.abs(simulated).max()) ** 2
    loud = more * np.random.default_rng(seed).standard_normal(len(simulated))
    result = diagnosed(changed(recording, **{ANGLE: recording.values(ANGLE) + loud}))
    assert names(result) == set()
    assert result.diagnoses[0].verdict == "no_mismatch"
    assert any("times as large as usual" in note for note in result.diagnoses[0].notes)


def test_the_rounding_of_numbers_is_not_said_to_be_loud():
    recording = recorded({}, cycles=9, noise=0.0, gain=1.0, offset=0.0)
    same = changed(recording, **{ANGLE: recording.values(SIMULATED)})
    assert not any("times as large" in note for note in diagnosed(same).diagnoses[0].notes)

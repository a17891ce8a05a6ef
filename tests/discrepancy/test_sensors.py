"""Counts of an encoder, and samples that a slower sensor says again."""

import numpy as np
import pandas as pd
import pytest
from scipy.signal import lfilter

from pipeline.config import DiagnosisConfig
from pipeline.discrepancy.problem.counts import between_counts, quantum_of, smooth_motion
from pipeline.discrepancy.problem.rough import behind_known_noise, noise_of_motion, unroughened
from pipeline.discrepancy.problem.stale import hung_samples, stale_samples
from pipeline.physics.backlash import Backlash
from pipeline.physics.motion import Motion
from pipeline.physics.play_operator import play
from pipeline.recording import Channel, Recording, with_context
from pipeline.stages.diagnosis import diagnose, posed

TIME_S = np.arange(3000) * 0.01
MOVED = 20.0 * np.sin(2.0 * np.pi * 0.13 * TIME_S)
COUNT = 0.35


def counted(values: np.ndarray) -> np.ndarray:
    return COUNT * np.round(values / COUNT)


def noise(size: float) -> np.ndarray:
    return size * np.random.default_rng(3).standard_normal(len(TIME_S))


def recorded(command: np.ndarray, measured: np.ndarray) -> Recording:
    channels = (
        Channel("shaft_deg", "command", "deg"),
        Channel("horn_deg", "measurement", "deg"),
        Channel("horn_sim_deg", "simulation", "deg", of="horn_deg"),
    )
    samples = pd.DataFrame(
        {"time_s": TIME_S, "shaft_deg": command, "horn_deg": measured, "horn_sim_deg": command}
    )
    return Recording(with_context(samples, channels), channels)


def test_what_moved_is_found_between_the_counts_of_an_encoder() -> None:
    counts = counted(MOVED)
    assert quantum_of(counts) == pytest.approx(COUNT)
    assert quantum_of(MOVED) == 0.0
    smooth = between_counts(counts, COUNT)
    assert np.all(np.abs(smooth - counts) < 0.5001 * COUNT)
    assert np.std(smooth - MOVED) < 0.25 * np.std(counts - MOVED)


def test_counts_stay_where_the_measurement_goes_in_the_same_steps_even_late() -> None:
    counts = counted(MOVED)
    assert smooth_motion(counts, MOVED + noise(0.02))[1] == pytest.approx(COUNT)
    for late in (0, 5):
        followed, quantum = smooth_motion(counts, np.roll(counts, late) + noise(0.02))
        assert quantum == 0.0
        assert followed is counts


def test_a_staircase_that_is_followed_late_and_with_play_is_no_encoder() -> None:
    stairs = 100.0 * np.round(8.0 * np.sin(2.0 * np.pi * 0.05 * TIME_S))
    stairs = stairs[np.arange(3000) // 50 * 50]
    played = play(stairs, 20.0, 0.0)
    for rows in (3.0, 20.0):
        fade = np.exp(-1.0 / rows)
        late = lfilter([1.0 - fade], [1.0, -fade], played)
        followed, quantum = smooth_motion(stairs, late + noise(1.0))
        assert quantum == 0.0
        assert followed is stairs


def test_stairs_of_equal_length_are_no_encoder_though_the_joint_is_far_too_slow_to_show_them() -> (
    None
):
    """A probe told to go on by 0.8 deg every seven rows comes after it by five rows, and bends."""
    turns = np.abs((np.arange(300) + 10) % 42 - 21.0)
    stairs = 0.8 * np.repeat(turns, 7)
    late = lfilter([0.18], [1.0, -0.82], stairs)
    late = late + 2e-3 * late**2 + noise(0.02)[: len(stairs)]
    followed, quantum = smooth_motion(stairs, late)
    assert quantum == 0.0
    np.testing.assert_array_equal(followed, stairs)


def test_the_noise_of_a_measured_command_is_no_lag_behind_it() -> None:
    rough = MOVED + noise(0.3)
    assert noise_of_motion(rough) == pytest.approx(0.3, rel=0.1)
    assert noise_of_motion(MOVED) == 0.0
    motion = Motion(MOVED, TIME_S, np.zeros(3000, dtype=np.int64))
    play = Backlash().respond(MOVED, motion, np.array([3.0]), None)[0]
    measured = play + np.random.default_rng(8).normal(0.0, 0.1, 3000)
    smooth, found = unroughened(rough, TIME_S, measured)
    assert found == pytest.approx(0.3, rel=0.1)
    assert np.std(smooth - MOVED) < 0.1
    assert unroughened(rough, TIME_S, rough + noise(0.02))[0] is rough
    assert np.array_equal(behind_known_noise(rough, TIME_S, found), smooth)
    assert behind_known_noise(MOVED, TIME_S, found) is MOVED
    given = recorded(rough, measured)
    problem = posed(DiagnosisConfig(), given, "horn_deg")
    assert problem.rough == pytest.approx(0.3, rel=0.1)
    assert np.std(problem.motion.drive - MOVED) < 0.1


def test_an_uneven_clock_is_no_noise_of_a_motion_and_hides_none() -> None:
    off = np.random.default_rng(7).uniform(-0.4, 0.4, len(TIME_S))
    uneven_s = TIME_S + off * (TIME_S[1] - TIME_S[0])
    moved = np.interp(uneven_s, TIME_S, MOVED)
    assert noise_of_motion(moved) > 0.0
    assert noise_of_motion(moved, uneven_s) == 0.0
    assert noise_of_motion(MOVED, uneven_s) == 0.0
    assert noise_of_motion(moved + noise(0.3), uneven_s) == pytest.approx(0.3, rel=0.1)


def test_samples_that_are_said_again_are_told_from_levels_and_from_play() -> None:
    measured = MOVED + noise(0.1)
    held = measured[np.arange(3000) // 5 * 5]
    found = stale_samples(held, MOVED)
    assert found.even
    assert np.array_equal(found.rows, np.arange(3000) % 5 > 0)

    hangs = np.random.default_rng(4).random(3000) < 0.3
    hangs[0] = False
    last = np.maximum.accumulate(np.where(hangs, 0, np.arange(3000)))
    found = stale_samples(measured[last], MOVED)
    assert not found.even
    assert np.array_equal(found.rows, hangs)

    motion = Motion(MOVED, TIME_S, np.zeros(3000, dtype=np.int64))
    play = Backlash().respond(MOVED, motion, np.array([4.0]), None)[0]
    assert np.mean(np.diff(play) == 0.0) > 0.1
    assert not stale_samples(play, MOVED).rows.any()
    assert not stale_samples(counted(measured), MOVED).rows.any()
    mistaken = counted(measured)
    mistaken[[500, 1200, 2100, 2800]] += (3.1, 5.73, 4.4, 7.27)
    assert not stale_samples(mistaken, MOVED).rows.any()
    slow = 20.0 * COUNT * np.sin(2.0 * np.pi * TIME_S / TIME_S[-1])
    assert not stale_samples(counted(slow), slow).rows.any()


def test_a_sensor_that_hung_leaps_to_where_the_motion_is() -> None:
    measured = MOVED + noise(0.1)
    rows = np.arange(3000)
    last = np.where((rows > 1000) & (rows < 1030), 1000, rows)
    assert np.array_equal(np.flatnonzero(hung_samples(measured[last], MOVED)), rows[1001:1030])
    assert not hung_samples(measured, MOVED).any()
    assert not hung_samples(np.clip(measured, None, np.quantile(measured, 0.9)), MOVED).any()
    motion = Motion(MOVED, TIME_S, np.zeros(3000, dtype=np.int64))
    play = Backlash().respond(MOVED, motion, np.array([4.0]), None)[0]
    assert not hung_samples(play, MOVED).any()
    assert not hung_samples(measured[rows // 8 * 8], MOVED).any()


def test_play_is_named_alone_behind_counts_and_a_slower_sensor() -> None:
    motion = Motion(MOVED, TIME_S, np.zeros(3000, dtype=np.int64))
    play = Backlash().respond(MOVED, motion, np.array([3.0]), None)[0]
    measured = (play + noise(0.15))[np.arange(3000) // 2 * 2]
    result = diagnose(DiagnosisConfig(), recorded(counted(MOVED), measured))
    (found,) = result.diagnoses
    assert [p.name for p in found.physics] == ["backlash"]
    assert found.after.heldout_rmse < 1.1 * 0.15
    assert any("counts of 0.35 deg" in note for note in found.notes)
    assert any(
        note.startswith("1500 of 3000 samples say to the last digit") for note in found.notes
    )


def test_what_a_coarse_converter_rounds_is_neither_outliers_nor_physics() -> None:
    command = np.random.default_rng(5).integers(-4, 5, 30)[np.arange(3000) // 100] * 10.0
    measured = COUNT * np.round((1.01 * command + 0.4 + noise(0.05)) / COUNT)
    (found,) = diagnose(DiagnosisConfig(), recorded(command, measured)).diagnoses
    assert found.verdict == "no_mismatch"
    assert found.noise > COUNT / np.sqrt(12.0)


def test_motion_at_random_that_a_play_takes_out_is_no_noise():
    rng = np.random.default_rng(1)
    drive = np.cumsum(2.0 * rng.standard_normal(1500))
    assert noise_of_motion(drive) > 0.0
    measured = play(drive, 2.0, 0.0) + 0.2 * rng.standard_normal(len(drive))
    assert unroughened(drive, TIME_S[:1500], measured) == (pytest.approx(drive), 0.0)


def test_equal_counts_of_noise_that_forgets_slowly_are_no_samples_said_again() -> None:
    fresh = np.random.default_rng(5).standard_normal(3000)
    slow = 0.1 * lfilter([np.sqrt(1.0 - 0.6**2)], [1.0, -0.6], fresh)
    counts = np.round((MOVED + slow) / 0.0137) * 0.0137
    written = np.round(1.0137 * counts + 0.2, 5)
    assert np.mean(np.diff(written) == 0.0) > 0.03
    assert quantum_of(written) == 0.0
    assert not stale_samples(written, MOVED).rows.any()

"""A zero that wanders smoothly: what it can follow, and where it stays."""

from dataclasses import replace

import numpy as np

from pipeline.physics.motion import Motion
from pipeline.physics.smooth_drift import PARTS, SmoothDrift
from pipeline.physics.term import Surroundings

AROUND = Surroundings(start_s=100.0, end_s=1100.0)
LATER = np.linspace(100.0, 2100.0, 401)
DRIVE = np.zeros(401)
MOTION = Motion(DRIVE, LATER, np.zeros(401, dtype=int))
SHAPE = np.array([[*row, 1000.0] for row in np.eye(PARTS)])


def test_a_smooth_course_is_followed_closely_and_is_held_after_the_recording():
    parts = np.array([SmoothDrift().respond(DRIVE, MOTION, v, None)[0] for v in SHAPE]).T
    recorded = AROUND.end_s >= LATER
    share = (LATER - 100.0) / 1000.0
    course = 0.8 * share**2 + np.exp(-share / 0.2) - 0.5 * np.cos(5.0 * share)
    columns = np.column_stack([parts, np.ones(len(LATER))])
    sizes = np.linalg.lstsq(columns[recorded], course[recorded], rcond=None)[0]
    left = course - columns @ sizes
    assert np.std(left[recorded]) < 0.1 * np.std(course[recorded])
    np.testing.assert_array_equal(np.ptp(parts[~recorded], axis=0), 0.0)


def test_its_end_is_the_recordings_and_no_fit_moves_it():
    until = SmoothDrift().parameters(AROUND)[-1]
    assert until.low == until.high == until.start == 1000.0
    assert until.weak
    assert SmoothDrift().void(np.append(np.zeros(PARTS), 1000.0))


def test_it_is_tried_where_the_rows_to_fit_on_go_on_nearly_to_the_end():
    for share, tried in ((0.67, False), (0.85, True), (1.0, True)):
        fitted = MOTION.rows(LATER - AROUND.start_s <= share * 1000.0)
        assert SmoothDrift().excited(fitted, AROUND) == tried


def test_it_is_tried_where_its_quickest_part_outlasts_a_cycle_as_a_wave_has_to():
    assert SmoothDrift().excited(MOTION, replace(AROUND, cycles=6))
    assert not SmoothDrift().excited(MOTION, replace(AROUND, cycles=5))


def test_each_size_is_the_rms_of_its_part_which_is_none_of_the_others():
    whole = replace(MOTION, time_s=np.linspace(100.0, 1100.0, 401))
    parts = [SmoothDrift().respond(DRIVE, whole, v, None)[0] for v in SHAPE]
    np.testing.assert_allclose(np.cov(parts, bias=True), np.eye(PARTS), atol=0.02)


def test_two_periods_of_which_none_is_the_others_leave_little_at_the_start():
    whole = replace(MOTION, time_s=np.linspace(100.0, 1100.0, 401))
    parts = np.array([SmoothDrift().respond(DRIVE, whole, v, None)[0] for v in SHAPE]).T
    share = np.linspace(0.0, 1.0, 401)
    course = np.sin(2.0 * np.pi * share / 0.47 + 1.0) + np.sin(2.0 * np.pi * share / 0.69 + 3.0)
    columns = np.column_stack([parts, np.ones(401)])
    left = course - columns @ np.linalg.lstsq(columns, course, rcond=None)[0]
    assert np.max(np.abs(left[:300])) < 0.12
    assert np.all(np.abs(parts[-1] - parts[-2]) < 0.02)

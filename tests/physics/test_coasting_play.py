"""A load with mass behind play: driven, coasting, stopped by friction."""

import numpy as np
import pytest

from pipeline.physics.catalogue import term
from pipeline.physics.motion import Motion
from pipeline.physics.play_operator import play
from pipeline.physics.term import Surroundings

WIDTH, STEP_S = 2.0, 0.002


def motion_of(drive: np.ndarray) -> Motion:
    n = len(drive)
    return Motion(drive, STEP_S * np.arange(n), np.zeros(n, dtype=int))


def load(drive: np.ndarray, drag: float, fading: float = 0.0) -> np.ndarray:
    motion = motion_of(drive)
    values = np.array([WIDTH, drag, fading])
    return term("backlash", "coasting").respond(motion.drive, motion, values, None)[0]


def stopping(speed: float) -> np.ndarray:
    """A drive that runs at a speed [1/s] for a second, then stands for another."""
    return speed * np.minimum(STEP_S * np.arange(1001), 1.0)


def test_a_load_that_friction_stops_at_once_is_plain_play():
    drive = 10.0 * np.sin(np.arange(3000) / 300.0)
    plain = play(drive, 0.5 * WIDTH, float(drive[0]))
    np.testing.assert_allclose(load(drive, drag=1e6), plain, atol=1e-9)


def test_a_load_coasts_the_way_that_dry_friction_takes_to_stop_it():
    speed, drag = 5.0, 10.0
    at = load(stopping(speed), drag)
    pushed = speed - 0.5 * WIDTH
    assert at[500] == pytest.approx(pushed, abs=0.02)
    assert at[-1] - pushed == pytest.approx(speed**2 / (2.0 * drag), rel=0.03)


def test_a_load_slowed_by_its_speed_coasts_one_time_constant_of_it():
    speed, fading = 5.0, 8.0
    at = load(stopping(speed), drag=1e-6, fading=fading)
    assert at[-1] - (speed - 0.5 * WIDTH) == pytest.approx(speed / fading, rel=0.03)


def test_a_load_never_leaves_its_gap():
    drive = 10.0 * np.sin(np.arange(3000) / 40.0)
    assert np.max(np.abs(load(drive, drag=1.0) - drive)) <= 0.5 * WIDTH + 1e-9


def test_a_load_that_meets_a_spring_is_thrown_back():
    """Into a drive that stands, at a speed v: as far beyond the gap as v / w0, and out at -v."""
    motion, speed, frequency = motion_of(np.zeros(1001)), 2.0, 25.0
    values = np.array([WIDTH, 1e-9, 0.0, frequency, 0.0])
    state = np.array([-STEP_S, 0.0, 0.0, speed])
    swinging = term("backlash", "elastic")
    at, _ = swinging.respond(motion.drive, motion, values, state)
    assert np.max(at) == pytest.approx(0.5 * WIDTH + speed / frequency, rel=0.01)
    met = (0.5 * WIDTH + np.pi / frequency * speed) / speed
    back = int((met + 0.5 * WIDTH / speed) / STEP_S)
    assert at[back] == pytest.approx(0.0, abs=0.03)
    assert (at[back + 50] - at[back]) / (50 * STEP_S) == pytest.approx(-speed, rel=0.02)


def test_a_load_on_a_spring_runs_behind_by_what_its_drag_stretches():
    speed, drag, frequency = 5.0, 60.0, 40.0
    motion = motion_of(stopping(speed)[:501])
    values = np.array([WIDTH, drag, 0.0, frequency, 0.7])
    at, _ = term("backlash", "elastic").respond(motion.drive, motion, values, None)
    behind = 0.5 * WIDTH + drag / frequency**2
    assert motion.drive[-1] - at[-1] == pytest.approx(behind, rel=1e-3)


def test_a_load_on_a_stiff_spring_that_swallows_its_swing_coasts():
    drive = 10.0 * np.sin(np.arange(3000) / 60.0)
    motion, drag = motion_of(drive), 300.0
    stiff = np.array([WIDTH, drag, 2.0, 2000.0, 1.0])
    at, _ = term("backlash", "elastic").respond(drive, motion, stiff, None)
    np.testing.assert_allclose(at, load(drive, drag, 2.0), atol=0.1 * WIDTH)


def test_what_is_sampled_seldom_shows_no_coasting():
    coasting, motion = term("backlash", "coasting"), motion_of(np.arange(10.0))
    assert coasting.excited(motion, Surroundings(dwell_s=STEP_S))
    assert not coasting.excited(motion, Surroundings(dwell_s=0.2))

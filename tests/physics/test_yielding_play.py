"""A load behind play whose flanks give."""

import numpy as np
import pytest

from pipeline.physics.catalogue import term
from pipeline.physics.motion import Motion
from pipeline.physics.play_operator import play
from pipeline.physics.term import Surroundings

WIDTH, STEP_S = 2.0, 0.01
YIELDING = term("backlash", "yielding")


def load(drive: np.ndarray, settling_s: float) -> np.ndarray:
    motion = Motion(drive, STEP_S * np.arange(len(drive)), np.zeros(len(drive), dtype=int))
    return YIELDING.respond(motion.drive, motion, np.array([WIDTH, settling_s]), None)[0]


def test_flanks_that_give_at_once_are_plain_play():
    drive = 10.0 * np.sin(np.arange(3000) / 40.0)
    plain = play(drive, 0.5 * WIDTH, float(drive[0]))
    np.testing.assert_allclose(load(drive, 0.0), plain, atol=1e-12)


def test_a_load_that_is_pushed_on_stays_behind_and_comes_after():
    """At a speed v by v times the settling time; where the drive stops, up to the flank."""
    speed, settling_s = 5.0, 0.02
    drive = speed * np.minimum(STEP_S * np.arange(400), 2.0)
    behind = drive - 0.5 * WIDTH - load(drive, settling_s)
    assert behind[190] == pytest.approx(speed * settling_s, rel=1e-6)
    assert behind[-1] == pytest.approx(0.0, abs=1e-9)


def test_it_stands_while_the_drive_turns_through_the_gap():
    drive = 5.0 - np.abs(np.arange(1001) / 100.0 - 5.0)
    at = load(drive, 0.005)
    across = slice(505, 695)
    assert np.ptp(at[across]) < 1e-9
    assert at[705] < at[600]


def test_it_is_what_fine_steps_come_to():
    """Explicit Euler, through corners, rests and flanks that meet within a sample."""
    fine, settling_s = 400, 0.008
    drive = np.interp(np.arange(301), [0, 40, 41, 60, 90, 95, 300], [0, 4, 9, 9, -7, 6, -1.5])
    asked = np.interp(np.arange(300 * fine + 1) / fine, np.arange(301), drive)
    at, out = asked[0], np.empty(len(asked))
    for i, u in enumerate(asked):
        beyond = np.sign(u - at) * max(abs(u - at) - 0.5 * WIDTH, 0.0)
        at += STEP_S / fine / settling_s * beyond
        out[i] = at
    np.testing.assert_allclose(load(drive, settling_s), out[::fine], atol=0.02)


@pytest.mark.parametrize(("settling_s", "slight"), [(0.005, False), (0.05, True)])
def test_what_gives_by_more_than_the_gap_is_no_flank(settling_s, slight):
    around = Surroundings(step=0.3, dwell_s=STEP_S)
    assert YIELDING.slight(np.array([WIDTH, settling_s]), around) == slight

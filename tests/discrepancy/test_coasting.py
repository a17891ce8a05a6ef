"""A geared servo that runs fast: its load coasts through the play."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from scipy.ndimage import gaussian_filter1d

from pipeline.discrepancy.judgement import beyond
from pipeline.physics.catalogue import term
from pipeline.physics.held import slewed
from pipeline.physics.motion import Motion
from pipeline.physics.play_operator import play
from pipeline.physics.slewing_motor import NO_FASTER
from pipeline.physics.term import Surroundings, values_of
from pipeline.recording import Recording
from tests.discrepancy.made import ANGLE, CHANNELS, SIMULATED, diagnosed, followed, names, value_of

STEP_S, NOISE = 0.01, 0.02
WIDTH, DRAG, FADING = 1.0, 60.0, 2.0


def servo(form: str = "coasting", swing: tuple[float, ...] = ()) -> Recording:
    """Sines of rising frequency, four of each, and a load that friction brakes slower than they.

    swing: natural frequency [rad/s] and damping of form "elastic".
    """
    parts = [
        a * np.sin(2.0 * np.pi * f * np.arange(0.0, 4.0 / f, STEP_S))
        for a, f in ((20.0, 0.3), (8.0, 0.3), (12.0, 1.0), (15.0, 0.5), (8.0, 1.5), (10.0, 0.8))
    ]
    drive = np.concatenate(parts)
    quarters = [4 * k + 4 * np.arange(len(part)) // len(part) for k, part in enumerate(parts)]
    motion = Motion(drive, STEP_S * np.arange(len(drive)), np.concatenate(quarters))
    steps = [np.arange(np.sum(motion.cycle == c)) for c in np.unique(motion.cycle)]
    values = np.array([WIDTH, DRAG, FADING, *swing])
    load = term("backlash", form).respond(drive, motion, values, None)[0]
    noise = NOISE * np.random.default_rng(3).standard_normal(len(drive))
    samples = pd.DataFrame({"time_s": motion.time_s, "cycle": motion.cycle,
                            "step": np.concatenate(steps), "pitch_command_deg": drive,
                            "yaw_command_deg": 0.0 * drive, ANGLE: load + noise,
                            SIMULATED: drive})  # fmt: skip
    return Recording(samples, CHANNELS, "simulated")


def capped() -> tuple[Recording, np.ndarray]:
    """Sines that run smoothly, the larger ones faster than a servo's 60 deg/s, and where it is."""
    recording = servo("coasting")
    drive = recording.samples["pitch_command_deg"].to_numpy(float)
    return recording, slewed(drive, np.full(len(drive), STEP_S), 0.03, 60.0, drive[0])


def seen(recording: Recording, angle: np.ndarray) -> Recording:
    """The recording with another angle (n,), and noise."""
    noise = NOISE * np.random.default_rng(4).standard_normal(len(angle))
    return replace(recording, samples=recording.samples.assign(**{ANGLE: angle + noise}))


def test_a_servo_that_can_go_no_faster_is_late_by_that_and_nothing_else():
    """No lag has a top speed: by itself it is more than the name says."""
    found = diagnosed(seen(*capped()))
    assert names(found) == {"response_lag"}
    assert found.diagnoses[0].after.heldout_rmse < 1.1 * NOISE
    assert abs(value_of(found, "response_lag", "top_speed").value - 60.0) < 1.0
    assert found.diagnoses[0].verdict == "partly_explained"
    assert found.diagnoses[0].unexplained.where == NO_FASTER


def test_a_top_speed_that_is_hardly_ever_reached_is_part_of_the_lag(monkeypatch):
    monkeypatch.setattr(beyond, "PART", 1.0)
    assert diagnosed(seen(*capped())).diagnoses[0].verdict == "explained"


@pytest.mark.long
def test_beside_other_names_a_servo_s_top_speed_is_part_of_how_late_it_is():
    recording, at = capped()
    found = diagnosed(seen(recording, at + 0.3 * np.sin(2.0 * np.pi * at / 7.0)))
    assert names(found) == {"response_lag", "transmission_ripple"}
    assert found.diagnoses[0].verdict == "explained"


def test_play_with_a_load_that_coasts_is_backlash_and_nothing_else():
    found = diagnosed(servo())
    assert names(found) == {"backlash"}
    assert found.diagnoses[0].after.heldout_rmse < 1.1 * NOISE
    for parameter, value in (("width", WIDTH), ("drag", DRAG), ("fading", FADING)):
        told = value_of(found, "backlash", parameter)
        assert abs(told.value - value) < 0.1 * value


def test_play_with_a_load_that_swings_where_teeth_meet_is_backlash_and_nothing_else():
    frequency = 60.0
    found = diagnosed(servo("elastic", (frequency, 0.15)))
    assert names(found) == {"backlash"}
    assert found.diagnoses[0].after.heldout_rmse < 1.2 * NOISE
    for parameter, value in (("width", WIDTH), ("natural_frequency", frequency)):
        told = value_of(found, "backlash", parameter)
        assert abs(told.value - value) < 0.1 * value


def test_play_with_a_load_that_coasts_does_not_grow_where_a_motion_gets_slower():
    """A motion that holds at its ends and swings less far later on, and so runs slower."""
    width, fading = 8.0, 25.0
    time_s = STEP_S * np.arange(2500)
    smaller = 1.0 - 0.4 * np.clip((time_s - 12.0) / 1.2, 0.0, 1.0)
    swing = np.clip(3.6 / np.pi * np.arcsin(np.sin(0.5 * np.pi * time_s)), -1.0, 1.0)
    drive = 45.0 * smaller * gaussian_filter1d(swing, 3.0)
    motion = Motion(drive, time_s, (0.25 * time_s).astype(int))
    values = np.array([width, 0.5, fading])
    load = term("backlash", "coasting").respond(drive, motion, values, None)[0]
    noise = 0.4 * np.random.default_rng(5).standard_normal(len(drive))
    found = diagnosed(followed(time_s, drive, load + noise, 0.25))
    assert names(found) == {"backlash"}
    assert abs(value_of(found, "backlash", "width").value - width) < 0.3
    assert abs(value_of(found, "backlash", "fading").value - fading) < 3.0


@pytest.mark.parametrize("dwell_s", [0.01, 0.04])
def test_teeth_however_soft_let_a_load_follow_within_a_few_samples(dwell_s):
    """Softer ones make the whole motion late, which is a lag and no play."""
    around = Surroundings(drive_span=60.0, dwell_s=dwell_s, end_s=40.0)
    elastic = term("backlash", "elastic")
    low = {p.name: p.low for p in elastic.parameters(around)}
    time_s = dwell_s * np.arange(400)
    ramp = Motion(10.0 * time_s, time_s, np.zeros(400, dtype=int))
    values = values_of(elastic, around, {**low, "damping": 0.7})
    behind = ramp.drive - elastic.respond(ramp.drive, ramp, values, None)[0]
    assert 0.0 < behind[-1] / 10.0 < 3.5 * dwell_s


@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.long
def test_a_lag_behind_play_at_one_speed_is_no_load_that_coasts(seed):
    """A triangle's lag is as much play more, but for the turns."""
    rows, late_s, width, fine = 2400, 0.0075, 6.4, 20
    time_s = 0.005 * np.arange(rows)
    drive = 30.0 * np.abs((2.0 * time_s / 3.0 + 0.5) % 2.0 - 1.0)
    shaft = play(np.interp(np.arange(rows * fine) / fine, np.arange(rows), drive), width / 2, 0.0)
    load = slewed(shaft, np.full(len(shaft), 0.005 / fine), late_s, np.inf, shaft[0])[::fine]
    angle = load + 0.05 * np.random.default_rng(seed).standard_normal(rows)
    found = diagnosed(followed(time_s, drive, angle, 1.0 / 3.0))
    assert names(found) == {"backlash", "response_lag"}
    assert value_of(found, "backlash", "width").value == pytest.approx(width, rel=0.05)

"""Old frames of a robot whose moves go at a steady speed."""

from collections.abc import Callable

import numpy as np
import pytest

from pipeline.physics.catalogue import richer, term
from pipeline.physics.frame_lag import FrameLag
from pipeline.physics.motion import Motion
from pipeline.physics.moved_frames import MovedFrames
from pipeline.physics.term import Surroundings
from tests.discrepancy.made import diagnosed_beside_its_commands, names, strokes

LAG_S, SPEED = 0.6, 5.0


def moves(count: int) -> Motion:
    """Steps of many sizes at 1, 3 or 10 s: the larger one is, the shorter its wait."""
    rng = np.random.default_rng(7)
    drive = strokes(rng.uniform(15.0, 45.0, count) * (-1.0) ** np.arange(count), 20)
    time_s = np.cumsum(rng.choice([1.0, 3.0, 10.0], len(drive)))
    return Motion(drive, time_s, np.zeros(len(drive), dtype=int))


def pose_of(motion: Motion, least_s: float) -> Callable[[np.ndarray], np.ndarray]:
    """Where a robot is at any times that goes to each command after the sample before."""
    u, t = motion.drive, motion.time_s

    def pose(at_s: np.ndarray) -> np.ndarray:
        k = np.clip(np.searchsorted(t, at_s), 1, len(t) - 1)
        moving_s = np.minimum(np.abs(u[k] - u[k - 1]) / SPEED + least_s, t[k] - t[k - 1])
        done = np.clip((at_s - t[k - 1]) / np.maximum(moving_s, 1e-9), 0.0, 1.0)
        return np.asarray(u[k - 1] + (u[k] - u[k - 1]) * done)

    return pose


@pytest.mark.parametrize(("form", "more"), [("moved", (0.0, 0.0)), ("blurred", (0.15, 0.4))])
def test_it_shows_where_a_robot_was(form: str, more: tuple[float, float]):
    motion, late = moves(6), MovedFrames(form)
    values = np.array([LAG_S, SPEED, *more][: 2 if form == "moved" else 4])
    before_s = np.linspace(0.0, more[1], 4001)[:, None]
    expected = np.mean(pose_of(motion, more[0])(motion.time_s - LAG_S - before_s), axis=0)
    whole = late.respond(motion.drive, motion, values, None)[0]
    np.testing.assert_allclose(whole, expected, atol=1e-3)


def test_an_old_frame_of_a_robot_that_moves_at_its_speed_is_told():
    motion = moves(50)
    seen = pose_of(motion, 0.0)(motion.time_s - LAG_S)
    noise = 0.15 * np.random.default_rng(8).standard_normal(len(motion))
    result = diagnosed_beside_its_commands(motion, seen + noise)
    assert names(result) == {"frame_lag"}
    assert result.diagnoses[0].after.heldout_rmse < 1.1 * 0.15


def test_an_old_frame_of_a_pose_that_was_held_is_told_where_waits_hardly_differ():
    """A sine in steps of 1.2 s, give or take 2 %, each move of which takes 0.8 s."""
    rng = np.random.default_rng(3)
    time_s = 1.2 * np.cumsum(1.0 + 0.025 * rng.uniform(-1.7, 1.7, 1500))
    drive = 29.0 * np.cos(2.0 * np.pi * np.arange(1500) / 188.0)
    reached = np.concatenate(
        [time_s[:1], np.column_stack([time_s[:-1] + 0.84, time_s[1:]]).ravel()]
    )
    poses = np.concatenate([drive[:1], np.repeat(drive[1:], 2)])
    seen = np.interp(time_s - 0.84, reached, poses) + 0.036 * rng.standard_normal(1500)
    motion = Motion(drive, time_s, np.zeros(1500, dtype=int))
    result = diagnosed_beside_its_commands(motion, seen)
    assert names(result) == {"frame_lag"}
    assert result.diagnoses[0].after.heldout_rmse < 1.05 * 0.036


@pytest.mark.parametrize("late", [FrameLag("held"), MovedFrames()])
def test_a_start_of_half_the_effect_is_not_from_when_the_pose_was_held(late: FrameLag):
    time_s = np.arange(40.0)
    motion = Motion(np.sin(time_s), time_s, np.zeros(40, dtype=int))
    values = np.array([0.7, 0.5 if late.form == "held" else 2.0])
    begun = late.scaled(values, 0.5)
    assert np.ptp(late.respond(motion.drive, motion, begun, None)[0] - motion.drive) > 0.1


def test_it_is_looked_for_where_waits_and_steps_differ_only():
    motion = moves(6)
    around = Surroundings(drive_span=90.0, dwell_s=1.0)
    even = Motion(np.arange(40.0), motion.time_s[:40], np.zeros(40, dtype=int))
    steady = Motion(motion.drive, np.arange(len(motion)) * 3.0, motion.cycle)
    shown = [MovedFrames().excited(m, around) for m in (motion, even, steady)]
    assert shown == [True, False, False]


def test_moves_of_one_time_may_stand_in_its_place_and_both_hold_more_when_blurred():
    motion, around = moves(6), Surroundings(drive_span=90.0, dwell_s=1.0)
    told = MovedFrames().instead(np.array([LAG_S, SPEED]), motion, around)
    assert all(isinstance(t, FrameLag) and t.form == "held" for ((t, _),) in told)
    assert all(values[0] == LAG_S for ((_, values),) in told)
    for form in ("held", "moved"):
        assert [t.form for t in richer(term("frame_lag", form))] == ["blurred"]

"""A simulation with rigid friction: what holds all friction takes the place of its jump."""

import numpy as np
import pandas as pd
import pytest

from pipeline.config import DiagnosisConfig
from pipeline.discrepancy.problem.jumping import between_branches
from pipeline.physics.play_operator import play
from pipeline.recording import Channel, Recording, with_context
from pipeline.stages.diagnosis import diagnose

N, RATE = 1800, 50.0
PHASE = 2.0 * np.pi * np.arange(N) / 200
PULL = 60.0 + 40.0 * np.sin(PHASE) * (0.7 + 0.3 * np.cos(PHASE / 3.0))
WRAP, NOISE = 0.3, 0.3


def rigid(pull, wrap):
    """The capstan equation with the sign of the velocity."""
    return pull * np.exp(-wrap * np.sign(np.gradient(pull)))


def sheathed(pull, wrap):
    """What comes out of a sheath: it stands still until the pull is past friction either way."""
    out, at = np.empty(len(pull)), pull[0]
    for k, here in enumerate(pull):
        at = min(max(at, here * np.exp(-wrap)), here * np.exp(wrap))
        out[k] = at
    return out


@pytest.fixture(scope="module")
def found():
    measured = sheathed(PULL, WRAP) + np.random.default_rng(3).normal(0.0, NOISE, N)
    channels = (
        Channel("tension_in_n", "command", "N"),
        Channel("tension_out_n", "measurement", "N"),
        Channel("tension_out_sim_n", "simulation", "N", of="tension_out_n"),
    )
    columns = {
        "time_s": np.arange(N) / RATE,
        "tension_in_n": PULL,
        "tension_out_n": measured,
        "tension_out_sim_n": rigid(PULL, 0.15),
    }
    table = with_context(pd.DataFrame(columns), channels)
    return diagnose(DiagnosisConfig(), Recording(table, channels, "simulated")).diagnoses[0]


def test_a_sheath_is_named_with_all_its_friction_beside_a_rigid_simulation_of_half_of_it(found):
    (friction,) = found.physics
    assert friction.name == "friction"
    assert friction.parameters[0].name == "wrap"
    assert friction.parameters[0].value == pytest.approx(WRAP, rel=0.03)
    assert found.after.heldout_rmse < 1.1 * NOISE


def test_before_stays_the_simulation_as_it_came_and_the_notes_say_what_stands_for_it(found):
    off = sheathed(PULL, WRAP) - rigid(PULL, 0.15)
    assert found.before.train_rmse == pytest.approx(np.sqrt(np.mean(off**2)), rel=0.1)
    assert any("jumps with the direction of tension_in_n" in note for note in found.notes)


def test_no_lens_and_no_weight_bends_a_force(found):
    assert {"camera_tilt", "lens_distortion", "gravity"} <= set(found.not_excited)


def test_what_slides_over_or_is_one_curve_does_not_jump():
    assert between_branches({"pull": PULL}, play(PULL, 8.0, 0.0)) is None
    assert between_branches({"pull": PULL}, 0.7 * PULL - 1e-3 * PULL**2) is None


def test_rows_before_the_motion_begins_do_not_count():
    still = np.full(100, PULL[0])
    pull = np.concatenate([still, PULL])
    middle = between_branches({"pull": pull}, np.concatenate([still, rigid(PULL, 0.15)]))
    assert middle is not None
    assert np.max(np.abs(middle / pull / np.cosh(0.15) - 1.0)) < 0.01


def test_what_comes_late_does_not_jump():
    pull = 60.0 + 40.0 * np.sin(PHASE)
    assert between_branches({"pull": pull}, 60.0 + 40.0 * np.sin(PHASE - 0.5)) is None
    assert between_branches({"pull": PULL}, np.interp(PHASE - 0.5, PHASE, PULL)) is None


def test_what_goes_on_where_the_command_rests_is_late():
    levels = 2.67 * np.array([1, 2, 3, 4, 3, 2, 1, 0, -1, -2, -3, -4, -3, -2, -1, 0])
    dwell = [20, 9, 9, 9, 2, 20, 2, 20, 20, 2, 9, 20, 2, 2, 9, 20]
    ends = np.cumsum(np.column_stack([np.full(16, 2.5), dwell]).ravel())
    once = np.interp(np.arange(ends[-1]), np.r_[0.0, ends], np.r_[0.0, np.repeat(levels, 2)])
    command = np.tile(once, 10)
    late = np.zeros_like(command)
    for k in range(1, len(late)):
        late[k] = command[k] + (late[k - 1] - command[k]) * np.exp(-0.12)
    assert between_branches({"command": command}, late) is None


def test_a_command_that_rests_between_its_steps_may_be_noisy():
    rng = np.random.default_rng(4)
    levels = rng.uniform(20.0, 100.0, 24)
    at = np.arange(2400) / 100.0
    pull = (
        np.interp(at % 1.0, [0.0, 0.4], [0.0, 1.0]) * np.diff(levels, prepend=60.0)[at.astype(int)]
    )
    pull += np.concatenate([[60.0], levels[:-1]])[at.astype(int)]
    way = np.sign(np.gradient(pull))
    noisy = pull + rng.normal(0.0, 0.1, len(pull))
    middle = between_branches({"pull": noisy}, noisy * np.exp(-0.15 * way))
    assert middle is not None
    assert np.median(np.abs(middle / pull / np.cosh(0.15) - 1.0)) < 0.01

"""The little that a simulation does beside its curve may be a course of its own, or its trace."""

import numpy as np
import pytest

from pipeline.discrepancy.judgement.form import INSIDE, LATE_INSIDE, limits_of
from pipeline.discrepancy.problem.course import course_of
from pipeline.physics.play_operator import varying_play
from tests.discrepancy.made import (
    ANGLE,
    NOISE,
    SIMULATED,
    changed,
    diagnosed,
    names,
    posed,
    recorded,
)

KNOWN, WIDER = 0.3, 2.2


@pytest.fixture(scope="module")
def knowing():
    """A simulation that knows a little play, beside which a joint's grows from cycle to cycle."""
    plain = recorded({}, seed=6)
    command, cycle = plain.values("pitch_command_deg"), plain.values("cycle")
    simulated, wider = (
        0.7 * varying_play(command, 0.5 * width, command[0])
        for width in (np.full(len(command), KNOWN), KNOWN + WIDER * np.log1p(cycle + 1.0))
    )
    noise = NOISE * np.random.default_rng(6).standard_normal(len(command))
    return changed(plain, **{ANGLE: 1.02 * wider + noise, SIMULATED: simulated})


def test_its_curve_its_course_and_its_trace_are_all_at_hand(knowing):
    problem = posed(knowing)
    assert problem.static
    assert problem.course is None
    assert problem.coursed is not None
    assert problem.coursed.course is not None
    assert problem.coursed.traced is problem.traced is not None
    assert not problem.traced.static


def test_what_is_left_out_is_told_beside_it(knowing):
    result = diagnosed(knowing)
    assert names(result) == {"tension_loss"}
    assert result.diagnoses[0].after.heldout_rmse < 1.1 * NOISE


def test_of_a_small_loop_no_lag_is_taken_that_leaves_much_more_than_friction(knowing):
    commands = {"pitch_command_deg": knowing.values("pitch_command_deg")}
    course = course_of(commands, knowing.values("time_s"), knowing.values(SIMULATED))
    assert course is not None
    assert {p.term.name for p in course.own.pieces} <= {"backlash", "friction"}


def test_beside_play_of_its_own_no_lag_is_a_form_as_it_is_beside_a_lag(knowing):
    coursed = posed(knowing).coursed
    assert coursed is not None
    assert INSIDE in limits_of("response_lag", coursed, True)
    assert LATE_INSIDE not in limits_of("response_lag", coursed, True)
    assert LATE_INSIDE in limits_of("response_lag", posed(knowing).traced, True)

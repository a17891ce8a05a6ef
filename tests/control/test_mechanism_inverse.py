import numpy as np
import pytest

from pipeline.control.mechanism_inverse import follow_mechanism
from pipeline.control.trial import trial_path
from pipeline.physics.assembly import pieces_of
from pipeline.physics.kinematics import CubicCurve
from pipeline.physics.mechanism import Mechanism
from pipeline.physics.term import Surroundings

BOUNDS = (-70.0, 70.0)


def with_play(width_deg: float) -> Mechanism:
    return Mechanism(
        CubicCurve(0.8, 1e-5), pieces_of({"backlash": {"width": width_deg}}, Surroundings())
    )


def test_every_target_of_a_path_with_reversals_is_met():
    targets = np.concatenate([trial_path(40, 38.0), [5.0, 3.0, 8.0, -4.0]])
    solutions = follow_mechanism(with_play(4.0), targets, BOUNDS, 1e-6, 3.0, [60.0, -60.0, 0.0])
    assert {s.status for s in solutions} == {"converged"}
    assert max(abs(s.model_deg - t) for s, t in zip(solutions, targets, strict=True)) < 1e-6


def test_the_play_is_gone_through_after_a_reversal():
    solutions = follow_mechanism(with_play(4.0), [10.0, 20.0, 10.0], BOUNDS, 1e-6, 3.0)
    up, _, down = (s.command_deg for s in solutions)
    assert up - down == pytest.approx(4.0, abs=1e-6)


def test_a_target_beyond_the_bounds_says_so_and_the_path_goes_on():
    solutions = follow_mechanism(with_play(4.0), [80.0, 10.0], BOUNDS, 1e-6, 3.0)
    assert [s.status for s in solutions] == ["unreachable", "converged"]
    assert solutions[0].command_deg == BOUNDS[1]


def test_a_target_that_is_reached_already_moves_nothing():
    solutions = follow_mechanism(with_play(4.0), [10.0, 10.0], BOUNDS, 1e-6, 3.0)
    assert solutions[1].command_deg == solutions[0].command_deg
    assert solutions[1].iterations == 0

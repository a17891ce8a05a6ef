"""Slips at the very start: how a wire lay there is no slip of a shaft."""

import numpy as np
import pytest

from pipeline.discrepancy.fitting.fit import evaluate
from pipeline.discrepancy.fitting.ground import Ground, ground_of
from pipeline.discrepancy.judgement.first_slip import is_start, start_note
from pipeline.discrepancy.noise.noise import NoiseModel
from pipeline.physics.catalogue import term
from pipeline.physics.piece import Piece
from pipeline.recording import reversals_of
from tests.discrepancy.made import NOISE, posed, recorded

PLAY = Piece(term("backlash"), np.array([0.05]))


@pytest.fixture(scope="module")
def ground() -> Ground:
    problem = posed(recorded({}))
    return ground_of(problem, NoiseModel(NOISE), problem.train)


@pytest.mark.parametrize(("after_turn_s", "start"), [(-90.0, True), (-2.0, True), (2.0, False)])
def test_a_slip_before_a_wire_first_turns_says_how_it_lay(ground, after_turn_s, start):
    motion = ground.problem.motion
    time_s = motion.time_s[reversals_of(motion.drive)[0]] + after_turn_s
    slip = Piece(term("lost_steps"), np.array([-1.5, time_s]))
    fit = evaluate(ground, [slip, PLAY])
    assert is_start(fit, slip) == start
    assert not is_start(fit, PLAY)
    assert len(start_note(fit)) == start
    assert not is_start(evaluate(ground, [slip]), slip)
    twice = Piece(term("lost_steps", "twice"), np.array([-1.5, time_s, 1.0, time_s + 400.0]))
    assert not is_start(evaluate(ground, [twice, PLAY]), twice)

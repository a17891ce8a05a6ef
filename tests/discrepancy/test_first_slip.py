"""Slips at the very start: how a wire lay there is no slip of a shaft."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pipeline.discrepancy.judgement.first_slip import is_start, start_note
from pipeline.physics.catalogue import term
from pipeline.physics.mechanism import Piece
from pipeline.physics.motion import Motion

TIME_S = np.arange(400) * 0.1
DRIVE = 10.0 * np.sin(2.0 * np.pi * TIME_S / 10.0)


PLAY = Piece(term("backlash"), np.array([0.05]))


def fit_of(*pieces: Piece) -> Any:
    motion = Motion(DRIVE, TIME_S, np.zeros(400, dtype=np.int64))
    problem = SimpleNamespace(motion=motion, around=SimpleNamespace(drive_unit="mm"))
    ground = SimpleNamespace(problem=problem)
    return SimpleNamespace(ground=ground, pieces=pieces, names=tuple(p.term.name for p in pieces))


@pytest.mark.parametrize(("time_s", "start"), [(0.05, True), (2.05, True), (3.05, False)])
def test_a_slip_before_a_wire_first_turns_says_how_it_lay(time_s, start):
    slip = Piece(term("lost_steps"), np.array([-1.5, time_s]))
    fit = fit_of(slip, PLAY)
    assert is_start(fit, slip) == start
    assert not is_start(fit, PLAY)
    assert len(start_note(fit)) == start
    assert not is_start(fit_of(slip), slip)
    twice = Piece(term("lost_steps", "twice"), np.array([-1.5, time_s, 1.0, 20.05]))
    assert not is_start(fit_of(twice, PLAY), twice)

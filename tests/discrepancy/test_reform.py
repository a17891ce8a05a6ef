"""Forms of a term that hold more than the one that was found."""

import numpy as np
import pytest

from pipeline.config import DiagnosisConfig
from pipeline.discrepancy.fit import evaluate, ground_of, improve
from pipeline.discrepancy.noise import NoiseModel
from pipeline.discrepancy.problem import pose_problem
from pipeline.discrepancy.reform import reformed
from pipeline.physics.catalogue import term
from pipeline.physics.mechanism import Piece
from tests.discrepancy.made import recorded

QUIET = 0.05


@pytest.mark.parametrize("apart", [(0.083, 6.7, 0.05, 34.0), (0.12, 7.0, 0.08, 60.0)])
def test_creep_of_two_times_is_found_from_the_one_between_them(apart):
    names = ("share", "time_constant", "share_2", "time_constant_2")
    hidden = dict(zip(names, apart, strict=True))
    recording = recorded({"creep/two": hidden}, noise=QUIET)
    simulated = recording.values("pitch_angle_sim_deg")
    problem = pose_problem(DiagnosisConfig(), recording, "pitch_angle_deg", simulated)
    ground = ground_of(problem, NoiseModel(QUIET, 0.0, 0.0), problem.train)
    truth = improve(evaluate(ground, [Piece(term("creep", "two"), np.array(apart))]), 10)
    between = improve(evaluate(ground, [Piece(term("creep", "one"), np.array([0.1, 25.0]))]), 20)
    assert between.cost > truth.cost + 30.0
    assert reformed(between, 0, term("creep", "two")).cost < truth.cost + 1.0

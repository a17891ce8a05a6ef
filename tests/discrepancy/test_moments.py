"""Moments of slips: which rows tell them apart."""

import numpy as np
import pytest

from pipeline.discrepancy.fitting.fit import evaluate
from pipeline.discrepancy.fitting.ground import ground_of
from pipeline.discrepancy.fitting.moments import moments, settle_moments
from pipeline.discrepancy.noise.noise import NoiseModel
from pipeline.physics.catalogue import term
from pipeline.physics.piece import Piece
from tests.discrepancy.made import NOISE, STEPS, posed, recorded

LAG = {"response_lag": {"time_constant": 20.0}}


@pytest.mark.parametrize(("before", "told"), [(1, True), (4, True), (40, False)])
def test_a_lag_tells_how_long_before_the_first_row_fitted_a_slip_was(before, told):
    """The third cycle is held out: a slip in it shows in what the fourth begins with."""
    times = recorded({}).values("time_s")
    row = 3 * STEPS - before
    slipped_s = 0.5 * (times[row] + times[row - 1])
    problem = posed(recorded(LAG | {"lost_steps": {"jump": 8.0, "time": slipped_s}}, seed=3))
    ground = ground_of(problem, NoiseModel(NOISE), problem.train)
    lag = Piece(term("response_lag"), np.array([20.0]))
    slip = Piece(term("lost_steps"), np.array([8.0, times[3 * STEPS] + 5.0]))
    begun = evaluate(ground, (lag, slip))
    settled = settle_moments(begun)
    found_s = settled.pieces[1].values[1]
    assert (abs(found_s - slipped_s) < 1.0) == told
    assert (np.min(np.abs(moments(begun) - found_s)) > 1.0) == told

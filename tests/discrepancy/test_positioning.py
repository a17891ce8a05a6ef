"""Tests of positioning: few targets far apart, from either side, of a simulation with own play."""

import numpy as np
import pytest

from pipeline.physics.play_operator import play
from tests.discrepancy.made import diagnosed, followed, names, posed

TARGETS, CYCLES, HALF, NOISE, RANGE = 20, 8, 0.045, 0.004, 130.0


def positioned(drifting: float):
    """Targets up and down again, a simulation that knows the play, and a zero that moves."""
    rng = np.random.default_rng(4)
    up = np.linspace(-RANGE, RANGE, TARGETS) + rng.uniform(-2.0, 2.0, TARGETS)
    drive = np.tile(np.concatenate([up, up[::-1]]), CYCLES)
    time_s = 5.1 * np.arange(1.0, len(drive) + 1.0)
    simulated = play(drive, HALF, drive[0] - HALF)
    seen = 1.001 * simulated + drifting * time_s / time_s[-1]
    seen = seen + NOISE * rng.standard_normal(len(drive))
    return followed(time_s, drive, seen, 1.0 / (5.1 * 2 * TARGETS), simulated)


def test_play_that_the_simulation_knows_is_left_out_by_nobody():
    result = diagnosed(positioned(0.12))
    assert names(result) == {"drift"}
    assert result.diagnoses[0].verdict == "explained"
    assert result.diagnoses[0].after.heldout_rmse < 1.2 * NOISE


def test_what_is_taken_off_both_is_that_play():
    assert posed(positioned(0.0)).own == pytest.approx(HALF, rel=0.1)

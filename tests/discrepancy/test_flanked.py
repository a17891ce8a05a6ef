"""Play whose flanks give, in place of play and a lag: not where what is late shows."""

import numpy as np
import pytest

from pipeline.discrepancy.fitting.fit import evaluate, improve
from pipeline.discrepancy.fitting.ground import ground_of
from pipeline.discrepancy.noise.noise import NoiseModel
from pipeline.discrepancy.search.flanked import small
from pipeline.physics.catalogue import term
from pipeline.physics.piece import Piece
from pipeline.physics.play_operator import play
from tests.discrepancy.made import followed, posed

STEP_S, WIDTH, NOISE, ROWS, FINE = 0.016, 8.0, 0.2, 1500, 20


def servo(late_s: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times, a quick motion, and a load behind play that comes late as a whole, (n,) each."""
    time_s = STEP_S * np.arange(ROWS)
    drive = 30.0 * np.sin(2.0 * np.pi * time_s) + 12.0 * np.sin(9.3 * time_s)
    fine_s = np.arange(FINE * (ROWS - 1) + 1) * STEP_S / FINE
    shaft = play(np.interp(fine_s, time_s, drive), 0.5 * WIDTH, 0.0)
    kept, at, load = np.exp(-STEP_S / FINE / late_s), 0.0, np.empty(len(shaft))
    for i, asked in enumerate(shaft):
        at = asked + (at - asked) * kept
        load[i] = at
    return time_s, drive, load[::FINE]


@pytest.mark.parametrize(("late_s", "told"), [(5e-4, False), (0.0095, True)])
def test_what_flanks_that_give_took_of_a_lag_counts_as_a_lag(late_s: float, told: bool) -> None:
    time_s, drive, load = servo(late_s)
    seen = load + NOISE * np.random.default_rng(3).standard_normal(ROWS)
    problem = posed(followed(time_s, drive, seen, 1.0))
    ground = ground_of(problem, NoiseModel(NOISE), problem.train)
    given = Piece(term("backlash", "yielding"), np.array([WIDTH, 0.5 * STEP_S]))
    lag = Piece(term("response_lag", "running"), np.array([1e-3]))
    fit = improve(evaluate(ground, [given, lag]), 20)
    assert small(fit, *fit.pieces) != told
    if told:
        beside = improve(evaluate(ground, fit.pieces[:1]))
        assert beside.mean_square - fit.mean_square < NOISE**2

"""Baselines recover what they can represent, and never see a row that is held out."""

import numpy as np
import pytest

from pipeline.models.baselines import (
    MODELS,
    TIMED_MODELS,
    coupled_play,
    own_play,
    prandtl_ishlinskii,
    prandtl_ishlinskii_and_time,
    strongest_first,
)
from pipeline.physics.play_operator import play

N = 600
TIME = np.arange(N) / 20.0
COMMANDS = np.column_stack([30 * np.sin(TIME) * np.cos(TIME / 7), 20 * np.sin(TIME * 1.3 + 1)])
TRAIN = np.arange(N) < 400


def played(width_0: float, width_1: float) -> np.ndarray:
    plays = [play(np.ascontiguousarray(COMMANDS[:, k]), 0.5 * w, COMMANDS[0, k])
             for k, w in enumerate((width_0, width_1))]  # fmt: skip
    return 0.8 * plays[0] - 0.3 * plays[1] + 2.0


@pytest.mark.parametrize(("model", "limit"), [(coupled_play, 0.25), (prandtl_ishlinskii, 0.25)])
def test_two_plays_are_foretold(model, limit):
    measured = played(6.0, 3.0)
    error = measured - model(COMMANDS, measured, TRAIN)
    assert np.sqrt(np.mean(error[~TRAIN] ** 2)) < limit


def test_two_plays_on_a_zero_that_drifts_are_foretold():
    timed = np.column_stack([COMMANDS, TIME])
    measured = played(6.0, 3.0) - 0.4 * TIME
    error = measured - prandtl_ishlinskii_and_time(timed, measured, TRAIN)
    without = measured - prandtl_ishlinskii(COMMANDS, measured, TRAIN)
    assert np.sqrt(np.mean(error[~TRAIN] ** 2)) < 0.25
    assert np.sqrt(np.mean(without[~TRAIN] ** 2)) > 2.0


def test_own_play_knows_the_first_command_alone():
    measured = played(6.0, 3.0)
    alone = measured - own_play(COMMANDS, measured, TRAIN)
    assert np.std(alone[~TRAIN]) > 2.0


@pytest.mark.parametrize("model", [*MODELS, *TIMED_MODELS], ids=lambda m: m.name)
def test_held_out_rows_are_not_looked_at(model):
    few = slice(0, N, 6)
    commands, measured, train = COMMANDS[few], played(6.0, 3.0)[few], TRAIN[few]
    spoilt = np.where(train, measured, 1000.0)
    answers = [model.predict(commands, m, train) for m in (measured, spoilt)]
    assert np.array_equal(*answers)


def test_commands_come_in_the_order_of_their_say():
    ranked = strongest_first([COMMANDS[:, 1], np.ones(N), COMMANDS[:, 0]], played(1.0, 1.0), TRAIN)
    assert np.array_equal(ranked, COMMANDS)

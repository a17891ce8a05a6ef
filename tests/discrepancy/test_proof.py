"""What held-out rows, and rows beyond the commands fitted, say against an explanation."""

import numpy as np
import pandas as pd
import pytest

from pipeline.config import DiagnosisConfig
from pipeline.discrepancy.fitting.fit import evaluate
from pipeline.discrepancy.fitting.ground import ground_of
from pipeline.discrepancy.judgement.proof import (
    BEYOND,
    HELDOUT,
    UNLIKE_REPEATS,
    UNWITNESSED,
    WALKS,
    refuted,
    strained,
    taken_for_a_walk,
)
from pipeline.discrepancy.noise.noise import NoiseModel
from pipeline.discrepancy.problem.posing import pose_problem
from pipeline.discrepancy.problem.problem import Problem
from pipeline.discrepancy.search.weighing import Choice
from pipeline.physics.catalogue import term
from pipeline.physics.piece import Piece
from pipeline.recording import Channel, Recording, with_context
from tests.discrepancy.made import explanation_of

ROWS = 900
NOISE, WALK = NoiseModel(white=0.2), NoiseModel(white=0.2, walk=0.1)
CHANNELS = (
    Channel("motor_deg", "command", "deg"),
    Channel("tip_deg", "measurement", "deg"),
    Channel("tip_sim_deg", "simulation", "deg", of="tip_deg"),
)


def posed(growing: float = 0.0) -> Problem:
    """Nine sines, each `growing` larger than the one before; the simulation is off by a tenth."""
    time_s = 0.1 * np.arange(ROWS)
    command = 40.0 * (1.0 + growing * (np.arange(ROWS) // 100)) * np.sin(0.2 * np.pi * time_s)
    columns = [time_s, command, 1.1 * command, command]
    samples = pd.DataFrame(
        np.column_stack(columns), columns=["time_s", *(c.name for c in CHANNELS)]
    )
    recording = Recording(with_context(samples, CHANNELS), CHANNELS, "simulated")
    return pose_problem(DiagnosisConfig(), recording, "tip_deg", command)


def left(problem: Problem, heldout: float, fitted: float = 1.0) -> np.ndarray:
    """Errors of so many deviations of the noise on held-out and on fitted rows."""
    size = np.where(problem.heldout, heldout, fitted) * NOISE.deviation
    return size * np.random.default_rng(1).standard_normal(len(size))


@pytest.mark.parametrize(
    ("off", "noise", "is_so"),
    [
        ((1.2, 1.0), NOISE, False),
        ((1.8, 1.0), NOISE, True),
        ((2.8, 2.8), NOISE, False),
        ((1.8, 1.0), WALK, False),
        ((2.5, 1.0), WALK, True),
    ],
)
def test_errors_far_beyond_the_noise_are_said_and_take_no_names(off, noise, is_so):
    problem = posed()
    every = np.ones(ROWS, dtype=bool)
    assert strained(problem, left(problem, *off), every, noise) == (HELDOUT if is_so else None)
    assert not refuted(problem, left(problem, *off), every)


def test_what_lies_beyond_the_commands_fitted_refutes_nothing_and_is_said():
    problem = posed(0.1)
    off = left(problem, 1.0)
    far = np.abs(problem.motion.drive) > np.abs(problem.motion.drive[problem.train]).max()
    assert np.all(problem.heldout[far])
    off[far] *= 5.0
    every = np.ones(ROWS, dtype=bool)
    assert not refuted(problem, off, every)
    assert strained(problem, off, every, NOISE) == BEYOND
    assert strained(problem, off, ~far, NOISE) is None
    assert strained(posed(), off, every, NOISE) != BEYOND


def test_few_rows_say_less_where_they_are_alike():
    problem = posed()
    few, off = problem.train.copy(), left(problem, 1.0)
    rows = np.flatnonzero(problem.heldout)[:60]
    few[rows], off[rows] = True, 1.7 * NOISE.deviation
    lasting = NoiseModel(white=0.0, correlated=NOISE.white, correlation=0.8)
    assert strained(problem, off, few, NOISE) == HELDOUT
    assert strained(problem, off, few, lasting) is None


@pytest.mark.parametrize("correlation", [0.0, 0.5, 0.8])
def test_so_many_samples_say_of_the_noise_what_one_would(correlation):
    rng = np.random.default_rng(7)
    noise, rows = NoiseModel(white=0.3, correlated=1.0, correlation=correlation), 400
    fresh = rng.standard_normal((4000, rows)) * np.sqrt(1.0 - correlation**2)
    slow = np.empty_like(fresh)
    slow[:, 0] = rng.standard_normal(4000)
    for k in range(1, rows):
        slow[:, k] = correlation * slow[:, k - 1] + fresh[:, k]
    squares = np.mean((slow + 0.3 * rng.standard_normal(slow.shape)) ** 2, axis=1)
    alike = np.var(squares) / np.mean(squares) ** 2 * rows / 2.0
    assert noise.alike == pytest.approx(alike, rel=0.08)


@pytest.mark.parametrize(("times", "said"), [(4.5, None), (5.5, WALKS)])
def test_a_zero_that_walks_by_many_times_the_noise_is_not_all_said(times, said):
    problem, every = posed(), np.ones(ROWS, dtype=bool)
    assert strained(problem, left(problem, times, times), every, WALK) == said
    assert strained(problem, left(problem, times, times), every, WALK, 9.0) == WALKS
    assert strained(problem, left(problem, times, times), every, WALK, np.inf) is None
    assert strained(problem, left(problem, times, times), every, NOISE) is None


def test_at_which_level_it_walks_is_no_matter():
    problem, every = posed(), np.ones(ROWS, dtype=bool)
    off = left(problem, 1.0) + 8.0 * NOISE.deviation
    assert strained(problem, off, every, WALK) is None


@pytest.mark.parametrize(("jitter", "said"), [(0.0, HELDOUT), (0.02, None)])
def test_few_cycles_hardly_tell_how_far_the_zeros_of_others_jitter(jitter, said):
    problem, every = posed(), np.ones(ROWS, dtype=bool)
    zeros = np.array([0.6, -0.4, 1.4, 0.3, -0.5, -1.3, -0.2, 0.3, 1.5]) * NOISE.deviation
    off = left(problem, 1.0) + zeros[problem.cycle]
    assert strained(problem, off, every, NoiseModel(white=0.2, jitter=jitter)) == said
    far = off + 5.0 * NOISE.deviation * problem.heldout
    assert strained(problem, far, every, NoiseModel(white=0.2, jitter=jitter)) == HELDOUT


@pytest.mark.parametrize(
    ("pieces", "repeats", "noise", "strain", "said"),
    [
        (1, 0, WALK, 0.0, UNWITNESSED),
        (0, 0, WALK, 0.0, None),
        (1, 3, WALK, 0.0, None),
        (1, 3, WALK, 16.0, UNLIKE_REPEATS),
        (0, 3, WALK, 16.0, None),
        (1, 0, NOISE, 0.0, None),
    ],
)
def test_only_repeats_witness_that_a_zero_walks(pieces, repeats, noise, strain, said):
    problem = posed()
    ground = ground_of(problem, noise, problem.train)
    play = Piece(term("backlash"), np.array([1.0]))
    choice = Choice(evaluate(ground, [play] * pieces), (0, 0, 7), 0.0)
    explanation = explanation_of([choice], repeats=repeats, strain=strain)
    assert taken_for_a_walk(explanation, choice, np.full(ROWS, 0.6)) == said
    assert taken_for_a_walk(explanation, choice, np.full(ROWS, 0.3)) is None

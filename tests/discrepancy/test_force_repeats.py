"""A force whose motion was commanded and comes again: what leaps each time is no mistake."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from pipeline.config import DiagnosisConfig
from pipeline.discrepancy.fitting.fit import evaluate
from pipeline.discrepancy.fitting.ground import ground_of
from pipeline.discrepancy.judgement import cancelling as by_name
from pipeline.discrepancy.judgement.cancelling import LARGER, cancelling
from pipeline.discrepancy.noise.noise import NoiseModel
from pipeline.discrepancy.problem import force_problem
from pipeline.discrepancy.problem.force_problem import averaged, block_begins
from pipeline.discrepancy.problem.repeats import driven_again, rows_of_cycles
from pipeline.discrepancy.search.counted import farthest
from pipeline.discrepancy.search.force_delay import delay_of
from pipeline.physics.piece import Piece
from pipeline.physics.viscous_friction import ViscousFriction
from pipeline.recording import Channel, Recording, with_context
from pipeline.stages.diagnosis import diagnose, posed

RATE, SAMPLES, TIMES = 200.0, 1121, 4
CHANNELS = (
    Channel("position_m", "command", "m"),
    Channel("force_n", "measurement", "N"),
    Channel("force_sim_n", "simulation", "N", of="force_n"),
)


def bench(valve_n: float, beside_m: float = 0.0) -> Recording:
    """A damper of 3500 N s/m on a sweep that comes again; above 0.9 of its top speed a valve opens.

    beside_m: by how much the position of each sample was measured beside the one commanded.
    """
    rng = np.random.default_rng(5)
    t = np.arange(SAMPLES) / RATE
    sweep = 0.02 * np.sin(2.0 * np.pi * (0.5 * t + 0.22 * t**2)) * np.sin(np.pi * t / t[-1])
    x = np.tile(sweep, TIMES)
    v = np.gradient(x, 1.0 / RATE)
    force = 3500.0 * v
    opened = np.where(v > 0.9 * v.max(), -valve_n, 0.0)
    table = pd.DataFrame({
        "time_s": np.arange(len(x)) / RATE,
        "position_m": x + beside_m * rng.standard_normal(len(x)),
        "force_n": force + opened + rng.normal(0.0, 2.0, len(x)),
        "force_sim_n": force,
        "cycle": np.repeat(np.arange(TIMES), SAMPLES),
    })  # fmt: skip
    return Recording(with_context(table, CHANNELS), CHANNELS, "simulated")


def test_what_leaps_at_the_top_speed_of_every_cycle_is_a_mismatch():
    found = diagnose(DiagnosisConfig(), bench(valve_n=100.0)).diagnoses[0]
    assert found.verdict in ("unknown_physics", "partly_explained")
    # The valve's few samples count: without them calibration alone would leave the noise.
    assert found.before.heldout_rmse > 3.0 * 2.0
    assert found.after.heldout_rmse > 2.0 * 2.0


def test_blocks_stay_where_they_were_when_the_motion_is_moved():
    """Moved by part of a sample, the cycles of a motion need not come again to the sample."""
    problem = posed(DiagnosisConfig(), bench(0.0), "force_n")
    small, _ = averaged(problem)
    measured = posed(DiagnosisConfig(), bench(0.0, beside_m=1e-4), "force_n")
    elsewhere = replace(problem, motion=measured.motion)
    assert not driven_again(elsewhere)
    assert len(averaged(elsewhere)[0].motion) != len(small.motion)
    moved, _ = averaged(elsewhere, small.averaged)
    assert moved.averaged.begins.tolist() == small.averaged.begins.tolist()
    assert len(moved.motion) == len(small.motion)


def test_a_delay_is_found_in_the_blocks_that_were_fitted(monkeypatch):
    """Also where the motion, once moved, no longer comes again."""
    problem = posed(DiagnosisConfig(), bench(0.0), "force_n")
    small, _ = averaged(problem)
    ground = ground_of(small, NoiseModel(0.5), small.train)
    fit = evaluate(ground, [Piece(ViscousFriction(), np.zeros(1))])
    still = delay_of(problem, fit)
    monkeypatch.setattr(
        force_problem, "driven_again", lambda p: [] if p.delay.value else driven_again(p)
    )
    assert delay_of(problem, fit) == still


def test_blocks_begin_anew_with_each_cycle_of_a_motion_that_comes_again():
    small, size = averaged(posed(DiagnosisConfig(), bench(0.0), "force_n"))
    assert size > 1
    assert SAMPLES % size
    cycles = list(rows_of_cycles(small).values())
    drives = [small.motion.drive[rows] for rows in cycles]
    assert len(drives) == TIMES
    for drive in drives[1:]:
        np.testing.assert_array_equal(drive, drives[0][: len(drive)])
    assert [len(drive) for drive in drives[:-1]] == [SAMPLES // size] * (TIMES - 1)


@pytest.mark.parametrize("size", [SAMPLES - 1, SAMPLES + 1, SAMPLES // 2 + 1, SAMPLES // 3 + 1])
def test_cycles_hardly_longer_than_a_block_lose_no_samples_to_it(size):
    problem = posed(DiagnosisConfig(), bench(0.0), "force_n")
    begins = block_begins(problem, size)
    assert len(begins) * size >= 0.8 * (TIMES * SAMPLES // size) * size
    assert np.all(np.diff(begins) >= size)
    assert begins[-1] + size <= TIMES * SAMPLES


@pytest.mark.parametrize(("beside_m", "again"), [(0.0, 1), (1e-5, 0)])
def test_a_position_that_was_measured_never_comes_again_to_the_sample(beside_m, again):
    problem = posed(DiagnosisConfig(), bench(0.0, beside_m), "force_n")
    assert len(driven_again(problem)) == again


def test_what_is_off_at_all_the_highest_speeds_is_no_mistake():
    problem = posed(DiagnosisConfig(), bench(0.0), "force_n")
    velocity = problem.motion.kinetics.velocity
    fastest = velocity > 0.95 * velocity.max()
    anywhere = np.zeros_like(fastest)
    anywhere[::200] = True
    off = np.where(fastest | anywhere, -50.0, 0.0)
    np.testing.assert_array_equal(farthest(problem, off, fastest), fastest)
    assert not farthest(problem, off, anywhere & ~fastest).any()


@pytest.mark.parametrize(("size", "found"), [(0.9 * LARGER, False), (1.1 * LARGER, True)])
def test_terms_that_take_back_what_others_do_are_no_explanation(monkeypatch, size, found):
    """Two terms, each so many times as large as the mismatch that they leave of each other."""
    mismatch = np.tile([1.0, -1.0], 50)
    one, other = size * mismatch, (1.0 - size) * mismatch
    problem = SimpleNamespace(derivatives=True, measured=mismatch, simulated=np.zeros(100))
    ground = SimpleNamespace(problem=problem, used=np.ones(100, dtype=bool))
    fit = SimpleNamespace(
        ground=ground, pieces=("one", "other"), trace=SimpleNamespace(seen=one + other),
        without=lambda gone: ("other",) if gone == "one" else ("one",),
    )  # fmt: skip
    left = {("other",): other, ("one",): one}
    monkeypatch.setattr(by_name, "respond", lambda _, rest: SimpleNamespace(seen=left[rest]))
    assert cancelling(SimpleNamespace(fit=fit)) is found
    problem.derivatives = None
    assert not cancelling(SimpleNamespace(fit=fit))

"""A zero that walks: where it stood at the end, and predictions that go on from there."""

import json
from dataclasses import replace

import numpy as np
import pytest

from pipeline.config import DiagnosisConfig
from pipeline.discrepancy.fitting.fit import evaluate
from pipeline.discrepancy.fitting.ground import ground_of
from pipeline.discrepancy.model.model import as_json, from_json
from pipeline.discrepancy.model.zero import zero_at_end
from pipeline.discrepancy.noise.noise import NoiseModel
from pipeline.recording import Recording
from pipeline.stages.diagnosis import diagnose
from pipeline.stages.prediction import predict
from tests.discrepancy.made import NOISE, posed, recorded

NAME = "pitch_angle_deg"
STEP = 0.05 * NOISE


def walking(cycles: int) -> Recording:
    recording = recorded({}, seed=3, cycles=cycles)
    walk = np.cumsum(STEP * np.random.default_rng(7).normal(size=20 * 120))[: cycles * 120]
    samples = recording.samples.assign(**{NAME: recording.values(NAME) + walk})
    return replace(recording, samples=samples)


def test_the_zero_is_that_of_the_full_covariance():
    recording = walking(6)
    problem = posed(recording)
    noise = NoiseModel(0.1, 0.15, 0.6, 0.05, STEP)
    used = np.flatnonzero(problem.train)
    fit = evaluate(ground_of(problem, noise, problem.train), ())
    residual = (problem.measured - fit.predicted)[used]
    cycle = problem.cycle[used]
    covariance = (
        noise.white**2 * np.eye(len(used))
        + noise.correlated**2 * noise.correlation ** np.abs(used[:, None] - used)
        + noise.jitter**2 * (cycle[:, None] == cycle)
        + STEP**2 * np.minimum(used[:, None], used)
    )
    weights = np.linalg.solve(covariance, STEP**2 * used)
    zero = zero_at_end(problem, fit)
    assert zero is not None
    assert zero.level == pytest.approx(weights @ residual, rel=1e-6)
    left = STEP**2 * (len(problem.motion) - 1) - weights @ (STEP**2 * used)
    assert zero.deviation == pytest.approx(np.sqrt(left), rel=1e-6)
    assert zero_at_end(problem, evaluate(fit.ground.with_noise(NoiseModel(0.2)), ())) is None


def test_later_rows_are_predicted_from_where_the_zero_stood():
    model = diagnose(DiagnosisConfig(), walking(9)).models[0]
    assert model.mechanism.pieces == ()
    assert model.zero is not None
    longer = walking(12)
    table = predict([model], longer)
    frozen = predict([replace(model, zero=None)], longer)
    later = longer.values("cycle") >= 9
    off = {k: (t[f"{NAME}_predicted"] - longer.values(NAME)) for k, t in
           (("from the end", table), ("from the start", frozen))}  # fmt: skip
    assert (off["from the end"] == off["from the start"])[~later].all()
    end, start = (np.sqrt(np.mean(o[later] ** 2)) for o in off.values())
    assert end < 0.7 * start
    inside = np.abs(off["from the end"]) < 1.96 * table[f"{NAME}_std"]
    assert np.mean(inside[later]) > 0.8
    again = from_json(json.loads(json.dumps(as_json(model))), ["yaw_command_deg"])
    assert again.zero == model.zero

"""What foretells later rows has learnt from all rows; what is said of its own rows has not."""

import json
from dataclasses import replace
from typing import cast

import numpy as np
import pytest

from pipeline.config import DiagnosisConfig
from pipeline.discrepancy.fitting.fit import evaluate, improve
from pipeline.discrepancy.fitting.ground import ground_of
from pipeline.discrepancy.judgement.refit import in_course, likeliest
from pipeline.discrepancy.model.model import CorrectedModel, as_json, from_json
from pipeline.discrepancy.noise.noise import NoiseModel
from pipeline.physics.catalogue import term, terms
from pipeline.physics.mechanism import Mechanism
from pipeline.physics.piece import Piece
from pipeline.recording import Recording
from pipeline.stages.diagnosis import diagnose
from pipeline.stages.prediction import predict
from tests.discrepancy.made import NOISE, chosen, explanation_of, posed, recorded

NAME = "pitch_angle_deg"
HIDDEN = {"backlash": {"width": 4.0}, "drift/linear": {"rate": 1.0}}
CYCLES = 6


def start_of(recording: Recording) -> Recording:
    first = recording.values("cycle") < CYCLES
    return replace(recording, samples=recording.samples[first].reset_index(drop=True))


def model_of(recording: Recording) -> CorrectedModel:
    return diagnose(DiagnosisConfig(), recording).models[0]


def test_only_later_rows_know_the_held_out_cycles():
    longer = recorded(HIDDEN, seed=3, cycles=9)
    other = longer.samples.copy()
    other.loc[np.isin(other["cycle"], [2, 5]), NAME] += 0.05
    tables = [
        predict([model_of(start_of(r))], longer)[f"{NAME}_predicted"].to_numpy()
        for r in (longer, replace(longer, samples=other))
    ]
    later = longer.values("cycle") >= CYCLES
    assert (tables[0] == tables[1])[~later].all()
    assert (tables[1] - tables[0])[later].min() > 0.005


def test_later_rows_are_foretold_better_than_by_what_held_rows_out():
    square = {"all rows": 0.0, "rows fitted": 0.0}
    for seed in range(3):
        longer = recorded(HIDDEN, seed=seed, cycles=12)
        clean = recorded(HIDDEN, noise=0.0, cycles=12).values(NAME)
        later = longer.values("cycle") >= CYCLES
        model = model_of(start_of(longer))
        again = from_json(json.loads(json.dumps(as_json(model))), ["yaw_command_deg"])
        for who, m in (("all rows", again), ("rows fitted", replace(model, later=None))):
            off = predict([m], longer)[f"{NAME}_predicted"] - clean
            square[who] += float(np.sum(off[later] ** 2))
    assert square["all rows"] < 0.8 * square["rows fitted"]


def test_held_out_rows_tell_when_among_them_a_slip_was():
    slip_s = 3.0 + 3.36 * (2 * 120 + 70.5)
    model = model_of(recorded({"lost_steps": {"jump": 1.5, "time": slip_s}}, seed=5))
    first, later = model.mechanism.pieces[0], cast(Mechanism, model.later).pieces[0]
    assert abs(first.values[1] - slip_s) > 60.0
    assert abs(later.values[1] - slip_s) < 6.0
    assert later.values[0] == pytest.approx(1.5, abs=0.08)


def test_a_drift_too_unsure_to_be_named_still_goes_on():
    problem = posed(recorded(HIDDEN))
    ground = ground_of(problem, NoiseModel(NOISE), problem.train)
    play = {"backlash": [4.0]}
    named = chosen(ground, 2.0, **play)
    drifting = chosen(ground, 0.0, **play, drift=[0.5])
    slipping = chosen(ground, 1.0, **play, lost_steps=[0.5, 900.0])
    touching = chosen(ground, -3.0, **play, contact=[0.5, 20.0, 0.5])
    others = [chosen(ground, -5.0, friction=[2.0, 1.0, 0.7]), touching]
    explanation = explanation_of([*others, slipping, drifting, named])
    assert likeliest(explanation, named) is drifting
    assert likeliest(explanation, others[0]) is others[0]


TRAVEL = 6 * 4 * 55.0


@pytest.mark.parametrize(
    ("hidden", "form", "begun"),
    [
        (
            {"drift/exponential": {"amplitude": 1.5, "time_constant": 900.0}},
            "exponential",
            "linear",
        ),
        ({"drift/linear": {"rate": 4.0}}, "linear", "cycle"),
        (
            {"tension_loss/settling": {"growth": 0.01, "width": 1.0, "settled": 0.3 * TRAVEL}},
            "settling",
            "linear",
        ),
    ],
)
def test_what_evolves_takes_the_course_that_all_rows_show(
    hidden: dict[str, dict[str, float]], form: str, begun: str
):
    problem = posed(recorded(hidden))
    ground = ground_of(problem, NoiseModel(NOISE), problem.train)
    other = term(next(iter(hidden)).split("/")[0], begun)
    wrong = improve(
        evaluate(ground, [Piece(other, other.candidates(problem.motion, problem.around)[0])])
    )
    right = in_course(wrong, terms(["yaw_command_deg"]))
    assert right.pieces[0].term.form == form
    assert right.cost < wrong.cost
    assert in_course(right, terms(["yaw_command_deg"])).key == right.key

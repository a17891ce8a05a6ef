"""Predictions of a diagnosis' corrected simulation."""

import json
from dataclasses import replace

import numpy as np
import pytest

from pipeline.config import DiagnosisConfig
from pipeline.discrepancy.model.model import Hypothesis, ModelError, as_json, from_json
from pipeline.physics.catalogue import term
from pipeline.physics.mechanism import Mechanism
from pipeline.physics.piece import Piece
from pipeline.stages.diagnosis import diagnose
from pipeline.stages.prediction import predict
from tests.discrepancy.made import NOISE, recorded

HIDDEN = {"backlash": {"width": 4.0}, "drift/linear": {"rate": 2.0}}


@pytest.fixture(scope="module")
def model():
    recording = recorded(HIDDEN, seed=1)
    return diagnose(DiagnosisConfig(), recording).models[0]


def test_later_cycles_are_predicted_from_their_commands(model):
    longer = recorded(HIDDEN, seed=1, cycles=10, noise=0.0)
    table = predict([model], longer)
    assert list(table) == ["time_s", "pitch_angle_deg_predicted", "pitch_angle_deg_std"]
    off = table["pitch_angle_deg_predicted"] - longer.values("pitch_angle_deg")
    later = longer.values("cycle") >= 6
    assert np.sqrt(np.mean(off[later] ** 2)) < 0.4 * NOISE
    assert table["pitch_angle_deg_std"].iloc[-1] >= 0.9 * NOISE


def test_the_deviation_covers_new_measurements(model):
    longer = recorded(HIDDEN, seed=9, cycles=9)
    table = predict([model], longer)
    off = np.abs(table["pitch_angle_deg_predicted"] - longer.values("pitch_angle_deg"))
    inside = np.mean(off < 1.96 * table["pitch_angle_deg_std"])
    assert 0.9 < inside < 0.99


def of_rows(recording, first, later_s=0.0):
    samples = recording.samples[first:].reset_index(drop=True)
    return replace(recording, samples=samples.assign(time_s=samples["time_s"] + later_s))


def test_a_recording_that_goes_on_is_foretold_as_part_of_the_whole(model):
    longer = recorded(HIDDEN, seed=1, cycles=10, noise=0.0)
    rows = int(np.sum(longer.values("cycle") < 6))
    whole = predict([model], longer)[rows:].reset_index(drop=True)
    again = from_json(json.loads(json.dumps(as_json(model))), [])
    alone = predict([again], of_rows(longer, rows))
    np.testing.assert_allclose(alone["pitch_angle_deg_predicted"],
                               whole["pitch_angle_deg_predicted"], atol=1e-9)  # fmt: skip


def test_a_short_pause_ends_nothing(model):
    longer = recorded(HIDDEN, seed=1, cycles=10, noise=0.0)
    rows = int(np.sum(longer.values("cycle") < 6))
    name, pause_s = "pitch_angle_deg_predicted", 120.0
    at_once, later = (predict([model], of_rows(longer, rows, s))[name] for s in (0.0, pause_s))
    rate = next(p.values[0] for p in model.later.pieces if p.term.name == "drift")
    drifted = model.later.gain * rate * pause_s / 3600.0
    np.testing.assert_allclose(later - at_once, drifted, atol=1e-9)


@pytest.mark.parametrize("from_0", [False, True])
@pytest.mark.parametrize("left_out", [0, 30])
def test_cycles_go_on_though_a_recording_that_goes_on_numbers_them_from_0(from_0, left_out):
    longer = recorded({"drift/cycle": {"rate": 0.6}}, seed=1, cycles=10)
    rows = int(np.sum(longer.values("cycle") < 6)) - left_out
    begun = replace(longer, samples=longer.samples[:rows])
    model = diagnose(DiagnosisConfig(), begun).models[0]
    later = of_rows(longer, rows)
    cycle = later.samples["cycle"]
    numbered = replace(later, samples=later.samples.assign(cycle=cycle - from_0 * cycle[0]))
    whole = predict([model], longer)[rows:].reset_index(drop=True)
    alone = predict([model], numbered)
    np.testing.assert_allclose(alone["pitch_angle_deg_predicted"],
                               whole["pitch_angle_deg_predicted"], atol=1e-9)  # fmt: skip


def test_nobody_knows_how_a_motion_came_where_it_begins_elsewhere(model):
    longer = recorded(HIDDEN, seed=1, cycles=10, noise=0.0)
    rows = int(np.sum(longer.values("cycle") < 6)) + 25
    later = of_rows(longer, rows, 1e5)
    table = predict([replace(model, rivals=())], later)
    off = table["pitch_angle_deg_predicted"] - later.values("pitch_angle_deg")
    off -= off[len(off) // 2 :].mean()  # a drift goes on from nobody knows where
    deviation = table["pitch_angle_deg_std"]
    early = np.abs(off) > 5.0 * NOISE
    assert early.any()
    assert not early[60:].any()
    assert (np.abs(off) < 2.5 * deviation)[early].all()
    assert deviation[60:].max() < 2.0 * NOISE < deviation[0]


def test_a_single_row_is_foretold_as_widely_as_its_way_there_is_unknown(model):
    longer = recorded(HIDDEN, seed=1, cycles=10, noise=0.0)
    rows = int(np.sum(longer.values("cycle") < 6)) + 25
    few = of_rows(longer, rows, 1e5)
    table = predict([replace(model, rivals=())], replace(few, samples=few.samples.iloc[:1]))
    assert len(table) == 1
    assert table["pitch_angle_deg_std"].item() > 2.0 * NOISE


@pytest.fixture(scope="module")
def doubted(model):
    """The model with a rival of a quarter's probability that drifts by 6 deg an hour more."""
    pieces = [
        replace(p, values=p.values + 6.0) if p.term.name == "drift" else p
        for p in model.mechanism.pieces
    ]
    drifting = replace(model.mechanism, pieces=tuple(pieces))
    return replace(model, rivals=(Hypothesis(("drift",), 0.25, drifting),))


def test_rivals_that_foretell_something_else_widen_the_deviation(model, doubted):
    longer = recorded(HIDDEN, seed=1, cycles=10)
    sure, doubting = predict([replace(model, rivals=())], longer), predict([doubted], longer)
    name = "pitch_angle_deg"
    np.testing.assert_array_equal(doubting[f"{name}_predicted"], sure[f"{name}_predicted"])
    apart = doubting[f"{name}_std"] ** 2 - sure[f"{name}_std"] ** 2
    drift_deg = 6.0 * model.mechanism.gain * (longer.values("time_s") - 3.0) / 3600.0
    np.testing.assert_allclose(apart, 0.25 * drift_deg**2, atol=1e-9)


def test_a_stored_model_answers_the_same(doubted):
    model, recording = doubted, recorded(HIDDEN, seed=2)
    again = from_json(json.loads(json.dumps(as_json(model))), ["yaw_command_deg"])
    np.testing.assert_allclose(predict([again], recording), predict([model], recording))


def test_a_missing_command_is_refused(model):
    recording = recorded({})
    renamed = tuple(
        replace(c, name="x_command_deg") if c.name == "pitch_command_deg" else c
        for c in recording.channels
    )
    samples = recording.samples.rename(columns={"pitch_command_deg": "x_command_deg"})
    with pytest.raises(ModelError, match=r"command 'pitch_command_deg' that the model was fitted"):
        predict([model], replace(recording, channels=renamed, samples=samples))


def test_a_foreign_file_is_refused():
    with pytest.raises(ModelError, match=r"schema 'loopgap.model/4'; found 'other'"):
        from_json({"schema": "other"}, [])


def test_a_model_whose_parameters_had_other_names_is_refused(model):
    late = Piece(term("frame_lag", "held"), np.array([3.0, 0.5]))
    stored = json.loads(json.dumps(as_json(replace(model, mechanism=Mechanism(pieces=[late])))))
    assert stored["terms"][0]["parameters"] == {"lag": 3.0, "move": 0.5}
    stored["terms"][0]["parameters"] = {"lag": 3.0, "moving": 0.5}
    with pytest.raises(ModelError, match="expected parameters lag, move; found lag, moving"):
        from_json(stored, [])


def test_a_model_of_an_earlier_version_is_refused(model):
    with pytest.raises(ModelError, match="found 'loopgap.model/3'. Diagnose anew"):
        from_json(as_json(model) | {"schema": "loopgap.model/3"}, [])

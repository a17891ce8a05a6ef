"""Diagnosis and prediction as commands: the files that the contract promises."""

import json
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from pipeline import app
from pipeline.config import DiagnosisConfig
from pipeline.discrepancy.model.model import ModelError
from pipeline.discrepancy.model.result import VERDICTS
from pipeline.recording import Channel, Recording, save_recording
from pipeline.runners.diagnosis import answer, stored_models

CHANNELS = (
    Channel("pitch_command_deg", "command", "deg"),
    Channel("pitch_angle_deg", "measurement", "deg"),
    Channel("pitch_angle_sim_deg", "simulation", "deg", of="pitch_angle_deg"),
)


def triangle(cycles: int) -> np.ndarray:
    turn = np.arange(1, 200 * cycles + 1) / 200 % 1.0
    return 55.0 * np.interp(turn, [0.0, 0.25, 0.75, 1.0], [0.0, 1.0, -1.0, 0.0])


def with_play(command: np.ndarray, half_width: float) -> np.ndarray:
    out, at = np.empty_like(command), 0.0
    for i, value in enumerate(command):
        at = min(max(at, value - half_width), value + half_width)
        out[i] = at
    return out


def a_recording(half_width: float, cycles: int = 9) -> Recording:
    command = triangle(cycles)
    n = len(command)
    noise = np.random.default_rng(3).normal(0.0, 0.2, n)
    measured = 0.76 * with_play(command, half_width) + 0.4 + noise
    samples = pd.DataFrame(
        {"time_s": 3.35 * np.arange(1, n + 1), "cycle": np.arange(n) // 200,
         "step": np.arange(n) % 200, "pitch_command_deg": command, "pitch_angle_deg": measured,
         "pitch_angle_sim_deg": 0.75 * command}
    )  # fmt: skip
    return Recording(samples, CHANNELS, "test")


def loopgap(monkeypatch: pytest.MonkeyPatch, *arguments: str) -> int:
    monkeypatch.setattr(sys, "argv", ["loopgap", *arguments])
    return app.run_command_line()


def diagnosed(folder: Path, monkeypatch: pytest.MonkeyPatch, half_width: float) -> dict:
    save_recording(a_recording(half_width), folder / "recording")
    arguments = ["stages=[diagnosis]", f"recording={folder / 'recording'}"]
    assert loopgap(monkeypatch, *arguments, f"hydra.run.dir={folder / 'out'}") == 0
    content = json.loads((folder / "out" / "diagnosis.json").read_text())
    assert content["schema"] == "loopgap.diagnosis/1"
    (entry,) = content["measurements"]
    return entry


def test_play_is_named_located_and_proven(tmp_path, monkeypatch):
    entry = diagnosed(tmp_path, monkeypatch, half_width=2.0)
    assert entry["measurement"] == "pitch_angle_deg"
    assert entry["verdict"] in ("explained", "ambiguous")
    (physics,) = entry["physics"]
    assert physics["name"] == "backlash"
    assert physics["site"] == "transmission"
    (width,) = [p for p in physics["parameters"] if p["name"] == "width"]
    assert width["low"] < 4.0 < width["high"]
    assert width["unit"] == "deg"
    assert entry["after"]["heldout_rmse"] < 0.21 < 1.0 < entry["before"]["heldout_rmse"]
    assert physics["heldout_rmse_without"] > 1.0
    coordinates = {place["coordinate"] for place in entry["location"]}
    assert coordinates & {"direction", "travel"}
    assert 0.15 < entry["noise"] < 0.25
    assert "coupling" in entry["not_excited"]


def test_nothing_left_out_is_no_mismatch(tmp_path, monkeypatch):
    entry = diagnosed(tmp_path, monkeypatch, half_width=0.0)
    assert entry["verdict"] == "no_mismatch"
    assert entry["physics"] == []
    assert entry["next_experiment"] is None
    assert entry["calibration"]["gain"] == pytest.approx(0.76 / 0.75, abs=0.002)
    assert entry["calibration"]["offset"] == pytest.approx(0.4, abs=0.05)


def test_entry_has_the_keys_and_kinds_of_the_contract(tmp_path, monkeypatch):
    entry = diagnosed(tmp_path, monkeypatch, half_width=2.0)
    kinds = {
        "measurement": str, "unit": str, "verdict": str, "noise": float, "before": dict,
        "after": dict, "location": list, "physics": list, "calibration": dict,
        "unexplained": dict, "not_excited": list,
    }  # fmt: skip
    for key, kind in kinds.items():
        assert isinstance(entry[key], kind), key
    assert entry["verdict"] in VERDICTS
    assert set(entry["before"]) == set(entry["after"]) == {"train_rmse", "heldout_rmse"}
    assert set(entry["unexplained"]) == {"share", "p_value", "where"}
    for place in entry["location"]:
        assert set(place) == {"coordinate", "share", "p_value", "where"}
    for physics in entry["physics"]:
        assert set(physics) == {"name", "site", "probability", "parameters",
                                "heldout_rmse_without", "alternatives", "says"}  # fmt: skip
        for parameter in physics["parameters"]:
            assert set(parameter) == {"name", "value", "low", "high", "unit"}
            assert parameter["low"] <= parameter["value"] <= parameter["high"]


def test_prediction_answers_later_commands(tmp_path, monkeypatch):
    diagnosed(tmp_path, monkeypatch, half_width=2.0)
    later = a_recording(2.0, cycles=12)
    truth = later.values("pitch_angle_deg").copy()
    later.samples.loc[1800:, "pitch_angle_deg"] = np.nan
    save_recording(later, tmp_path / "later")
    arguments = ["stages=[prediction]", f"model={tmp_path / 'out'}",
                 f"recording={tmp_path / 'later'}", f"hydra.run.dir={tmp_path / 'p'}"]  # fmt: skip
    assert loopgap(monkeypatch, *arguments) == 0
    table = pd.read_csv(tmp_path / "p" / "predictions.csv")
    assert list(table.columns) == ["time_s", "pitch_angle_deg_predicted", "pitch_angle_deg_std"]
    assert len(table) == 2400
    error = truth[1800:] - table["pitch_angle_deg_predicted"].to_numpy()[1800:]
    deviation = table["pitch_angle_deg_std"].to_numpy()[1800:]
    assert np.sqrt(np.mean(error**2)) < 0.22
    assert 0.9 < np.mean(np.abs(error) < 1.96 * deviation) < 0.99


def test_a_log_says_what_a_diagnosis_is_at(tmp_path, monkeypatch, capsys):
    save_recording(a_recording(2.0), tmp_path / "recording")
    asked = ["stages=[diagnosis]", f"recording={tmp_path}/recording", "cache.use=false"]
    assert loopgap(monkeypatch, *asked, f"hydra.run.dir={tmp_path}/out") == 0
    said = capsys.readouterr()
    begun = [
        "  pitch_angle_deg (1 of 1): searching what was left out",
        "  pitch_angle_deg: where it was left out, and what to record next",
        "  drawing the figures and the report",
    ]
    assert said.err.splitlines() == begun
    assert not set(begun) & set(said.out.splitlines())


def test_measurements_are_counted_over_all_recordings():
    said: list[str] = []
    recordings = [a_recording(half_width, cycles=3) for half_width in (1.0, 2.0)]
    answer(DiagnosisConfig(), recordings, said.append)
    assert [line for line in said if "searching" in line] == [
        f"pitch_angle_deg ({k} of 2): searching what was left out" for k in (1, 2)
    ]


def test_prediction_without_a_model_says_what_it_needs(tmp_path, monkeypatch, capsys):
    save_recording(a_recording(2.0, cycles=3), tmp_path / "recording")
    arguments = ["stages=[prediction]", f"recording={tmp_path / 'recording'}",
                 f"hydra.run.dir={tmp_path / 'p'}"]  # fmt: skip
    assert loopgap(monkeypatch, *arguments) == 2
    assert "model=RUN_DIR" in capsys.readouterr().err
    assert loopgap(monkeypatch, *arguments, f"model={tmp_path}") == 2
    assert "a run with stages=[diagnosis]" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("own", "needed"),
    [
        ("[backlash: {width: 3}]", False),
        ("[friction: {width: 3, reach: 4}]", False),
        ("[lost_steps: {jump: 3, time: 900}]", True),
    ],
    ids=["play of its own", "friction of its own", "a slip of its own"],
)
@pytest.mark.long
def test_a_model_of_a_moving_simulation_is_asked_with_that_unless_it_was_taken_apart(
    tmp_path, monkeypatch, capsys, own, needed
):
    whole = a_recording(4.0)
    bare = replace(whole, channels=CHANNELS[:2]).samples.drop(columns="pitch_angle_sim_deg")
    save_recording(Recording(bare, CHANNELS[:2], "test"), tmp_path / "recording")
    asked = bare.drop(columns="pitch_angle_deg").head(300)
    save_recording(Recording(asked, CHANNELS[:1], "test"), tmp_path / "asked")
    (tmp_path / "mine.yaml").write_text(
        f"pitch_angle_deg: {{command: pitch_command_deg, gain: 0.75, terms: {own}}}"
    )
    simulated = ["simulation=mechanism", f"simulation.path={tmp_path}/mine.yaml"]
    diagnosis = ["stages=[diagnosis]", f"recording={tmp_path}/recording", *simulated]
    assert loopgap(monkeypatch, *diagnosis, f"hydra.run.dir={tmp_path}/out") == 0
    prediction = ["stages=[prediction]", f"model={tmp_path}/out", f"recording={tmp_path}/asked",
                  f"hydra.run.dir={tmp_path}/predicted"]  # fmt: skip
    assert loopgap(monkeypatch, *prediction) == int(needed)
    if needed:
        assert "or the same `simulation=`" in capsys.readouterr().err
        assert loopgap(monkeypatch, *prediction, *simulated) == 0
    said = pd.read_csv(tmp_path / "predicted" / "predictions.csv")["pitch_angle_deg_predicted"]
    clean = 0.76 * with_play(asked["pitch_command_deg"].to_numpy(), 4.0) + 0.4
    assert np.sqrt(np.mean((said - clean) ** 2)) < 0.2


def test_a_broken_model_is_refused(tmp_path, monkeypatch, capsys):
    save_recording(a_recording(2.0, cycles=3), tmp_path / "recording")
    (tmp_path / "model.json").write_text('{"models": [{"sch')
    asked = ["stages=[prediction]", f"recording={tmp_path}/recording", f"model={tmp_path}"]
    assert loopgap(monkeypatch, *asked, f"hydra.run.dir={tmp_path}/out") == 1
    assert "model.json: expected the models that a diagnosis left" in capsys.readouterr().err


def test_a_model_that_couples_needs_the_other_command(tmp_path):
    term = {"name": "coupling", "form": "yaw_command_deg/play", "parameters": {}}
    (tmp_path / "model.json").write_text(json.dumps({"models": [{"terms": [term]}]}))
    with pytest.raises(ModelError, match="the command 'yaw_command_deg' that the model was fitted"):
        stored_models(tmp_path / "model.json", a_recording(2.0, cycles=3))


def test_recording_that_is_too_short_is_refused(tmp_path, monkeypatch, capsys):
    whole = a_recording(2.0, cycles=1)
    save_recording(replace(whole, samples=whole.samples.head(2)), tmp_path / "recording")
    arguments = ["stages=[diagnosis]", f"recording={tmp_path / 'recording'}"]
    assert loopgap(monkeypatch, *arguments, f"hydra.run.dir={tmp_path / 'out'}") == 1
    assert "samples for a diagnosis; found 2" in capsys.readouterr().err

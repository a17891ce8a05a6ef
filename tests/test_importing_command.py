"""The command imports: published recordings by their mappings, and a diagnosis of what came in."""

import json
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy.io import loadmat

from pipeline import app
from pipeline.recording import Recording, load_recording


def loopgap(monkeypatch: pytest.MonkeyPatch, out: Path, *arguments: str) -> int:
    monkeypatch.setattr(sys, "argv", ["loopgap", *arguments, f"hydra.run.dir={out}"])
    try:
        return app.run_command_line()
    except SystemExit as stop:
        return int(stop.code or 0)


def imported(monkeypatch, out: Path, mapping: str, path: Path, *more: str) -> Recording:
    arguments = ["stages=[importing]", f"importing={mapping}", f"importing.path={path}", *more]
    assert loopgap(monkeypatch, out, *arguments) == 0
    return load_recording(out / "recording")


def test_i2ris_with_its_authors_simulation(published_recordings, tmp_path, monkeypatch, capsys):
    folder = published_recordings / "i2ris"
    recording = imported(monkeypatch, tmp_path, "i2ris", folder)
    measured = pd.read_csv(folder / "output_w_angles.csv")
    assert np.array_equal(recording.values("motor_0_command_count"), measured["Encoder counts 0"])
    assert np.allclose(recording.values("pitch_angle_deg"), measured["pitches"], atol=1e-12)
    assert int(np.isnan(recording.values("yaw_angle_deg")).sum()) == 5
    for angle, rmse in {"pitch_angle_deg": 7.92, "yaw_angle_deg": 10.08}.items():
        simulation = recording.simulation_of(angle)
        assert simulation is not None
        residual = recording.values(angle) - recording.values(simulation.name)
        assert np.sqrt(np.nanmean(residual**2)) == pytest.approx(rmse, abs=0.005)
    account = json.loads((tmp_path / "recording" / "importing.json").read_text())
    assert account["tables"]["simulation"]["resampled"] == "linear"
    assert account["empty"] == {"yaw_angle_deg": 5}
    assert "linear resampling of combined_data.csv" in recording.source
    assert "resampled (linear) to the first table's times" in capsys.readouterr().out


def test_dvrk_wrist_in_degrees(published_recordings, tmp_path, monkeypatch):
    folder = published_recordings / "dvrk_wrist" / "joint4_only"
    recording = imported(monkeypatch, tmp_path, "dvrk_wrist", folder)
    told, seen = np.load(folder / "q_des.npy"), np.load(folder / "q_act.npy")
    for joint in (4, 5, 6):
        assert np.allclose(
            recording.values(f"joint{joint}_command_deg"), np.degrees(told[:, joint - 1])
        )
        assert np.allclose(
            recording.values(f"joint{joint}_angle_deg"), np.degrees(seen[:, joint - 1])
        )
    stamps = np.load(folder / "t_stamp.npy")
    assert np.allclose(recording.values("time_s"), stamps - stamps[0], atol=1e-9)


@pytest.mark.parametrize("file", ["DATA_EMPS.mat", "DATA_EMPS_PULSES.mat"])
def test_emps_obeys_its_published_balance(file, published_recordings, tmp_path, monkeypatch):
    path = published_recordings / "emps" / file
    recording = imported(monkeypatch, tmp_path, "emps", path, "importing.rows.end_s=10")
    source = loadmat(path)
    rows = len(recording.samples)
    assert rows == np.count_nonzero(source["t"] - source["t"][0] < 10)
    force = (source["gtau"] * source["vir"]).ravel()[:rows]
    assert np.allclose(recording.values("force_n"), force, rtol=1e-12)
    assert np.array_equal(recording.values("position_m"), source["qm"].ravel()[:rows])

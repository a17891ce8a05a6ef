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
def test_emps_force_is_gtau_times_the_motor_command(
    file, published_recordings, tmp_path, monkeypatch
):
    path = published_recordings / "emps" / file
    recording = imported(monkeypatch, tmp_path, "emps", path, "importing.rows.end_s=10")
    source = loadmat(path)
    rows = len(recording.samples)
    assert rows == np.count_nonzero(source["t"] - source["t"][0] < 10)
    force = (source["gtau"] * source["vir"]).ravel()[:rows]
    assert np.allclose(recording.values("force_n"), force, rtol=1e-12)
    assert np.array_equal(recording.values("position_m"), source["qm"].ravel()[:rows])


def test_ones_own_file_from_start_to_diagnosis_and_prediction(tmp_path, monkeypatch, capsys):
    """The example of docs/importing.md: play of +-4 deg that a simulation left out."""
    turn = np.arange(1200) / 200 % 1.0
    motor = 50.0 * np.interp(turn, [0.0, 0.25, 0.75, 1.0], [0.0, 1.0, -1.0, 0.0])
    held, angle = 0.0, np.empty(1200)
    for i, value in enumerate(motor):
        held = min(max(held, value - 4.0), value + 4.0)
        angle[i] = 0.8 * held
    angle += np.random.default_rng(1).normal(0.0, 0.2, 1200)
    table = pd.DataFrame(
        {"Zeit [ms]": 250 * np.arange(1200), "Motor": motor * 65536 / 360,
         "Winkel": np.radians(angle), "Modell": np.radians(0.8 * motor)}
    )  # fmt: skip
    table.to_csv(tmp_path / "log.csv", sep=";", decimal=",", index=False)
    (tmp_path / "conf" / "importing").mkdir(parents=True)
    (tmp_path / "conf" / "importing" / "mine.yaml").write_text(example_mapping())
    arguments = [f"--config-dir={tmp_path / 'conf'}", "importing=mine",
                 "stages=[importing,diagnosis,prediction]",
                 f"importing.path={tmp_path / 'log.csv'}"]  # fmt: skip
    assert loopgap(monkeypatch, tmp_path / "out", *arguments) == 0
    (entry,) = json.loads((tmp_path / "out" / "diagnosis.json").read_text())["measurements"]
    assert entry["measurement"] == "elbow_angle_deg"
    assert "backlash" in [physics["name"] for physics in entry["physics"]]
    assert entry["after"]["heldout_rmse"] < 0.25 < 2.0 < entry["before"]["heldout_rmse"]
    predictions = pd.read_csv(tmp_path / "out" / "predictions.csv")
    error = predictions["elbow_angle_deg_predicted"] - angle
    assert np.sqrt(np.mean(error**2)) < 0.25
    assert "1200 rows" in capsys.readouterr().out


def example_mapping() -> str:
    """The mapping that docs/importing.md shows."""
    text = (Path(__file__).resolve().parents[1] / "docs" / "importing.md").read_text()
    return text.split("```yaml\n")[1].split("```")[0]


def test_mappings_to_start_from_take_names_from_the_command_line(tmp_path, monkeypatch):
    table = pd.DataFrame({"t": [0.0, 1.0, 2.0], "u": [0, 1, 2], "y": [0, 1, 3], "sim": [0, 1, 2]})
    table.to_csv(tmp_path / "log.csv", index=False)
    samples = "importing.tables.samples"
    columns = [f"{samples}.time.column=t", f"{samples}.channels.command.column=u",
               f"{samples}.channels.measurement.column=y",
               f"{samples}.channels.simulation.column=sim"]  # fmt: skip
    path = tmp_path / "log.csv"
    one = imported(monkeypatch, tmp_path / "1", "one_axis", path, *columns[:3])
    assert one.values("measurement").tolist() == [0, 1, 3]
    two = imported(monkeypatch, tmp_path / "2", "one_axis_simulated", path, *columns)
    assert two.simulation_of("measurement") is not None


@pytest.mark.parametrize(
    ("arguments", "status", "words"),
    [
        (["importing=emps"], 2, "importing.path: expected the file or folder to import"),
        (["importing.path=x.csv"], 2, "a table with `channels`; found none. Choose a mapping"),
        (["importing=nobody"], 2, "emps"),
        (["importing=emps", "importing.path=gone.mat"], 2, "expected a file or folder to import"),
        (["importing=emps", "importing.tables.drive.tme.unit=s"], 2, "tme"),
    ],
)
def test_an_import_asked_for_wrongly(arguments, status, words, tmp_path, monkeypatch, capsys):
    assert loopgap(monkeypatch, tmp_path, "stages=[importing]", *arguments) == status
    assert words in capsys.readouterr().err

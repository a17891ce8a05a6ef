"""Every study in conf/experiment runs at a small size."""

import json
import shlex
import shutil
import sys
from pathlib import Path

import pandas as pd
import pytest
from omegaconf import OmegaConf

from pipeline import app, collecting
from pipeline.config import DiagnosisConfig
from pipeline.recording import Recording, load_recording
from pipeline.stages.diagnosis import diagnose

ROOT = Path(__file__).resolve().parents[1]
SMALL_IMAGES = ["camera.width_px=504", "camera.height_px=378", "vision.workers=1"]


def loopgap(monkeypatch: pytest.MonkeyPatch, *arguments: str) -> int:
    monkeypatch.setattr(sys, "argv", ["loopgap", *arguments])
    return app.run_command_line()


def test_every_experiment_has_a_test():
    names = {file.stem for file in (ROOT / "conf" / "experiment").glob("*.yaml")}
    text = Path(__file__).read_text()
    assert {name for name in names if f"experiment={name}" not in text} == set()


@pytest.mark.long
def test_the_gap_is_closed_on_the_emulated_robot(tmp_path, monkeypatch):
    arguments = ["experiment=close_the_gap", *SMALL_IMAGES, "compensation.targets=24",
                 f"hydra.run.dir={tmp_path}"]  # fmt: skip
    assert loopgap(monkeypatch, *arguments) == 0
    rounds = sorted(tmp_path.glob("round-*"))
    (first,) = json.loads((rounds[0] / "diagnosis.json").read_text())["measurements"]
    (last,) = json.loads((rounds[-1] / "diagnosis.json").read_text())["measurements"]
    assert first["verdict"] == "ambiguous"
    assert first["next_experiment"]["commands"] == "next_commands.csv"
    proposed = pd.read_csv(rounds[0] / "next_commands.csv")
    recorded = load_recording(rounds[1] / "acquisition")
    assert recorded.values("pitch_command_deg").tolist() == proposed["pitch_command_deg"].tolist()
    assert last["verdict"] == "explained"
    assert [physics["name"] for physics in last["physics"]] == ["creep"]
    table = pd.read_csv(tmp_path / "evaluation" / "table.csv").set_index("judged by")
    seen = table.loc["robot, seen by camera"]
    assert seen["compensated RMSE [deg]"] < 0.6 * seen["nominal RMSE [deg]"]


@pytest.mark.long
def test_concealed_effects_are_found_and_the_seals_hold(tmp_path, monkeypatch):
    counts = "{none:2,walk:0,one:4,two:0,three:0,outside:0,small:0,known_none:0,known_one:2}"
    arguments = ["experiment=concealed", f"concealed.counts={counts}", f"hydra.run.dir={tmp_path}"]
    assert loopgap(monkeypatch, *arguments) == 0
    promised = json.loads((tmp_path / "cases" / "commitments.json").read_text())
    assert len(promised) == 8
    outcomes = pd.read_csv(tmp_path / "score" / "outcomes.csv")
    assert len(outcomes) == 8
    for name in ("requirements", "confusion", "calibration", "effects"):
        assert (tmp_path / "score" / f"{name}.md").stat().st_size > 50
    assert (tmp_path / "score" / "confusion.png").stat().st_size > 5000


def test_a_benchmark_of_no_cases_is_refused(tmp_path, monkeypatch, capsys):
    assert loopgap(monkeypatch, "stages=[concealed]", f"hydra.run.dir={tmp_path}") == 2
    said = capsys.readouterr().err
    assert "concealed.counts: expected how many cases of none, walk, one" in said
    assert "experiment=concealed" in said


STUDY = [*SMALL_IMAGES, "acquisition.cycles=5", "acquisition.steps_per_cycle=40",
         "selection.n_init=1", "training.n_init=1", "compensation.targets=8",
         "hydra/launcher=basic"]  # fmt: skip


@pytest.fixture(scope="module")
def kept_results(tmp_path_factory) -> str:
    """A folder in which the studies find each other's recordings."""
    return str(tmp_path_factory.mktemp("kept"))


@pytest.mark.parametrize(
    ("study", "jobs", "cells"),
    [
        (["experiment=paper_table", "seed=0", "split.index=0,3,9", "selection.k_max=2"], 3, 10),
        (["experiment=splits", "split.index=0,3", "selection.k_max=2"], 2, 10),
        (["experiment=k_sweep", "selection.k=1,2", "split.index=0,1"], 4, 44),
        (["experiment=step_rules", "selection.k_max=2", "split.index=0", "evaluation.trial=false",
          "compensation/step_rule=newton,armijo"], 2, 16),
        (["experiment=crossed", "split.index=0,3", "crossed.ks=[1,3]",
          "crossed.step_rules=[newton,armijo]"], 2, 12),
    ],
)  # fmt: skip
@pytest.mark.long
def test_a_study_leaves_its_table(study, jobs, cells, kept_results, tmp_path, monkeypatch):
    table = tmp_path / "tables" / study[0].removeprefix("experiment=")
    monkeypatch.setenv("LOOPGAP_CACHE", kept_results)
    assert loopgap(monkeypatch, "-m", *study, *STUDY, f"hydra.sweep.dir={tmp_path}") == 0
    results = pd.read_parquet(tmp_path / "results.parquet")
    assert results["job"].nunique() == jobs
    shown = pd.read_csv(table / "table.csv", comment="#")
    assert len(shown) == cells
    trial = shown["metric"].str.startswith("landing")  # not run at this size
    assert shown.loc[~trial, "mean"].notna().all()
    assert (shown.loc[~trial, "n"] == shown["n"].max()).all()
    assert collecting.run([str(tmp_path), "--check"]) == 0


def test_the_command_that_is_told_repeats_just_what_is_missing(kept_results, tmp_path, monkeypatch):
    study = ["experiment=splits", "split.index=0,3", "selection.k_max=2", *STUDY]
    monkeypatch.setenv("LOOPGAP_CACHE", kept_results)
    assert loopgap(monkeypatch, "-m", *study, f"hydra.sweep.dir={tmp_path}") == 0
    files = ["results.parquet", *(f"tables/splits/table.{s}" for s in ("tex", "md", "csv"))]
    whole = {name: (tmp_path / name).read_bytes() for name in files}
    shutil.rmtree(tmp_path / "1")
    assert collecting.run([str(tmp_path)]) == 1
    assert {name: (tmp_path / name).read_bytes() for name in files} != whole
    *_, command, collect = (tmp_path / "repeat.sh").read_text().splitlines()
    assert loopgap(monkeypatch, *shlex.split(command)[1:]) == 0
    assert collecting.run(shlex.split(collect)[1:]) == 0
    assert {name: (tmp_path / name).read_bytes() for name in files} == whole


@pytest.mark.long
def test_the_friction_of_a_real_drive_is_named(tmp_path, monkeypatch):
    real = ROOT.parent / "shared" / "recordings" / "emps"
    if not real.is_dir():
        pytest.skip("no recordings beside the checkout")
    arguments = ["experiment=real_emps", f"importing.path={real}", f"hydra.run.dir={tmp_path}"]
    assert loopgap(monkeypatch, *arguments) == 0
    errors = pd.read_csv(tmp_path / "force_study" / "errors.csv").set_index("model")
    own, others = errors.loc["diagnosis"], errors.drop(index="diagnosis")
    assert own["fitted recording (%)"] <= 3.2
    assert (own < others.min()).all()
    assert others.loc["symmetric least squares (published)"].iloc[0] == pytest.approx(4.08, abs=0.1)
    found = pd.read_csv(tmp_path / "force_study" / "parameters.csv").set_index("parameter")
    published = found["published"].notna() & (found.index != "offset")
    assert published.sum() == 3
    assert found.loc[published, "off (%)"].abs().max() < 2.0
    assert abs(found.loc["viscous_friction.asymmetry", "high"]) > 0.1
    ways = {n: found.loc[f"viscous_friction.damping {n}"] for n in ("rising", "falling")}
    assert ways["rising"]["high"] < 203.5 < ways["falling"]["low"]
    ways = {n: found.loc[f"coulomb_friction.force {n}"] for n in ("rising", "falling")}
    assert max(w["high"] - w["low"] for w in ways.values()) < 3.0  # alike, and surely so
    assert abs(ways["rising"]["found"] - ways["falling"]["found"]) < 1.0
    assert -0.001 < found.loc["delay", "found"] < 0.0  # a drive holds its command
    assert own["other recording (%)"] < 4.5
    (entry,) = json.loads((tmp_path / "diagnosis.json").read_text())["measurements"]
    assert {p["name"] for p in entry["physics"]} == {"viscous_friction", "coulomb_friction"}
    assert all(" rising and " in p["says"] for p in entry["physics"])
    assert entry["calibration"]["delay_s"] == pytest.approx(found.loc["delay", "found"])


@pytest.mark.long
def test_the_i2ris_robot_is_foretold_with_the_motors_that_drive_it(
    published_recordings, tmp_path, monkeypatch
):
    arguments = ["experiment=real_i2ris", f"importing.path={published_recordings / 'i2ris'}",
                 f"hydra.run.dir={tmp_path}"]  # fmt: skip
    assert loopgap(monkeypatch, *arguments) == 0
    entries = json.loads((tmp_path / "diagnosis.json").read_text())["measurements"]
    yaw, pitch = entries
    assert pitch["after"]["heldout_rmse"] <= 1.0
    assert yaw["after"]["heldout_rmse"] <= 1.0
    named = [
        {p["name"]: {p["name"], *p["alternatives"]} for p in e["physics"]} for e in (yaw, pitch)
    ]
    assert all("coupling" in names for names in named)
    assert {"drift", "lost_steps"} in named[0].values()  # 30 s can't tell them apart
    told = set().union(*named[1].values())
    assert told & {"drift", "lost_steps"}
    assert told & {"backlash", "creep", "friction", "response_lag"}
    report = (tmp_path / "report.html").read_text()
    assert "by motor_0_command_count" in report
    table = pd.read_csv(tmp_path / "baselines.csv").set_index("measurement")
    for entry in entries:
        own = table.loc[entry["measurement"]]
        best = own[~own["model"].str.startswith("diagnosis")]["held-out RMSE"].min()
        mine = own[own["model"].str.startswith("diagnosis")]["held-out RMSE"].item()
        assert mine < 1.05 * best
    assert (tmp_path / "figures" / "overview.png").stat().st_size > 20000


@pytest.fixture
def wrist(published_recordings, tmp_path, monkeypatch) -> Path:
    """The run that imported the dVRK wrist's random motion and fitted the baselines."""
    folder = published_recordings / "dvrk_wrist" / "random"
    arguments = ["experiment=real_dvrk", "stages=[importing,baselines]",
                 f"importing.path={folder}", f"hydra.run.dir={tmp_path}"]  # fmt: skip
    assert loopgap(monkeypatch, *arguments) == 0
    return tmp_path


def test_the_dvrk_wrist_is_compared_with_its_baselines(wrist):
    table = pd.read_csv(wrist / "baselines.csv").set_index(["measurement", "model"])
    heldout = table["held-out RMSE"]
    assert heldout["joint4_angle_deg", "simulation as it came"] == pytest.approx(10.1, abs=0.1)
    assert heldout["joint4_angle_deg", "own play"] == pytest.approx(1.85, abs=0.05)
    assert (
        heldout["joint6_angle_deg", "coupled play"] < 0.5 * heldout["joint6_angle_deg", "own play"]
    )


@pytest.mark.long
def test_the_joints_of_the_dvrk_wrist_are_named(wrist):
    """On the first 800 of 5531 samples: all of them take minutes."""
    whole = load_recording(wrist / "recording")
    early = Recording(whole.samples.iloc[:800], whole.channels, whole.source)
    settings = OmegaConf.load(ROOT / "conf" / "experiment" / "real_dvrk.yaml")["diagnosis"]
    config = OmegaConf.to_object(OmegaConf.merge(OmegaConf.structured(DiagnosisConfig), settings))
    joints = diagnose(config, early).diagnoses
    named = [{physics.name for physics in joint.physics} for joint in joints]
    assert (joints[0].verdict, named[0]) == ("no_mismatch", set())
    assert joints[1].verdict == joints[2].verdict == "partly_explained"
    assert {"coupling", "friction"} <= named[1]
    assert "friction" in named[2]
    assert all(joint.after.heldout_rmse < 0.4 * joint.before.heldout_rmse for joint in joints)

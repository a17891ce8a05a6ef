"""The command line: exit statuses, errors that name the key, stages on what an earlier run left."""

import hashlib
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from importlib import metadata
from importlib.util import find_spec
from pathlib import Path

import pandas as pd
import pytest
from hydra._internal.config_repository import CachingConfigRepository

from pipeline import app
from pipeline.config import EXTRA_STAGES, STAGES
from pipeline.recording import load_recording

ROOT = Path(__file__).resolve().parents[1]
SMALL = ["acquisition.cycles=4", "acquisition.steps_per_cycle=40", "selection.k_max=3",
         "compensation.targets=12", "vision.workers=1", "camera.width_px=504",
         "camera.height_px=378"]  # fmt: skip
BASIC = "hydra/launcher=basic"
LATER = "stages=[selection,training,compensation,evaluation]"


def loopgap(monkeypatch: pytest.MonkeyPatch, *arguments: str) -> int:
    monkeypatch.setattr(sys, "argv", ["loopgap", *arguments])
    try:
        return app.run_command_line()
    except SystemExit as stop:
        return int(stop.code or 0)


def _noting(made: list[object]) -> Callable[[CachingConfigRepository, object], None]:
    begin = CachingConfigRepository.__init__

    def noted(repository: CachingConfigRepository, delegate: object) -> None:
        made.append(repository)
        begin(repository, delegate)

    return noted


@pytest.fixture(scope="module")
def small_run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One small main job, by the command as a user gives it."""
    folder = tmp_path_factory.mktemp("main") / "run"
    command = [sys.executable, "-m", "pipeline.app", *SMALL, f"hydra.run.dir={folder}"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder


def test_main_job_leaves_every_result(small_run):
    assert json.loads((small_run / "job.json").read_text())["status"] == "done"
    for name in ("yaw", "pitch"):
        recording = load_recording(small_run / "vision" / name)
        assert len(recording.samples) == 160
        assert recording.values(f"{name}_angle_deg").std() > 10
    table = pd.read_csv(small_run / "evaluation" / "table.csv")
    assert set(table["axis"]) == {"yaw", "pitch"}
    assert (table["compensated RMSE [deg]"] < table["nominal RMSE [deg]"]).all()
    for name in ("evaluation/table.tex", "review/run.rrd", "review/figures/loops.pdf"):
        assert (small_run / name).stat().st_size > 500


def test_a_run_says_from_what_it_came(small_run):
    document = json.loads((small_run / "provenance.json").read_text())
    assert document["configuration"]["acquisition"]["cycles"] == 4
    assert document["packages"]["numpy"]
    assert (document["status"], document["seed"]) == ("done", 0)
    stages = {stage["stage"]: stage for stage in document["stages"]}
    assert list(stages) == list(STAGES)
    assert all(stage["made"] == "ran" and stage["wall_time_s"] > 0 for stage in stages.values())
    samples = "vision/yaw/samples.csv"
    assert stages["training"]["inputs"][samples] == stages["vision"]["outputs"][samples]
    assert "acquisition/yaw/frames/ (160 files)" in stages["vision"]["inputs"]
    text = (small_run / samples).read_bytes()
    assert stages["vision"]["outputs"][samples] == hashlib.sha256(text).hexdigest()
    if document["code"]["uncommitted"] is not None:
        diff = (small_run / document["code"]["diff"]).read_bytes()
        assert document["code"]["uncommitted"] == hashlib.sha256(diff).hexdigest()


def test_truth_is_beside_the_recording_and_not_in_it(small_run):
    truth = pd.read_csv(small_run / "acquisition" / "truth" / "yaw.csv")
    assert len(truth) == 160
    for samples in small_run.glob("*/yaw/samples.csv"):
        assert not [c for c in pd.read_csv(samples).columns if "true" in c]


def test_no_stage_before_evaluation_needs_the_truth(small_run, tmp_path, monkeypatch):
    blind = tmp_path / "blind"
    shutil.copytree(
        small_run / "acquisition", blind / "acquisition", ignore=shutil.ignore_patterns("truth")
    )
    arguments = [*SMALL, f"hydra.run.dir={tmp_path / 'again'}", f"earlier={blind}"]
    stages = "stages=[vision,selection,training,compensation]"
    assert loopgap(monkeypatch, *arguments, stages) == 0
    for name in ("vision/yaw/samples.csv", "training/pitch.json", "compensation/yaw.csv"):
        assert (tmp_path / "again" / name).read_bytes() == (small_run / name).read_bytes()


def test_some_stages_go_on_from_an_earlier_run(small_run, tmp_path, monkeypatch):
    arguments = [*SMALL, f"hydra.run.dir={tmp_path}", f"earlier={small_run}"]
    assert loopgap(monkeypatch, *arguments, "stages=[training]", "seed=3") == 0
    assert sorted(f.name for f in (tmp_path / "training").iterdir()) == ["pitch.json", "yaw.json"]


def test_a_recording_of_ones_own_is_trained_on(small_run, tmp_path, monkeypatch):
    source = small_run / "vision" / "yaw"
    arguments = [*SMALL, f"hydra.run.dir={tmp_path}", f"recording={source}"]
    assert loopgap(monkeypatch, *arguments, "stages=[selection,training]") == 0
    assert (tmp_path / "training" / "yaw.json").is_file()


def test_help_names_every_stage_and_no_schema(monkeypatch, capsys):
    assert loopgap(monkeypatch, "--help") == 0
    said = capsys.readouterr().out
    assert [stage for stage in (*STAGES, *EXTRA_STAGES) if stage not in said] == []
    assert "compensation/step_rule: armijo, barzilai" in said
    assert "schema" not in said


@pytest.mark.parametrize(
    ("asked", "meant"),
    [("experiment=K_Sweep", "k_sweep"), ("simulation=Identity", "identity"),
     ("compensation/step_rule=newtn", "newton"), ("selection.K=4", "k"), ("twin=papr", "paper")],
)  # fmt: skip
def test_an_option_or_key_that_nearly_is_one_is_suggested(asked, meant, monkeypatch, capsys):
    assert loopgap(monkeypatch, asked) == 2
    said = capsys.readouterr().err
    assert f"Did you mean '{meant}'?" in said
    assert "search path" not in said
    assert "provider=" not in said


@pytest.mark.parametrize("asked", [["stages=[none]"], ["--help"]])
def test_configuration_is_read_once(asked, tmp_path, monkeypatch):
    read = []
    monkeypatch.setattr(CachingConfigRepository, "__init__", _noting(read))
    loopgap(monkeypatch, *asked, f"hydra.run.dir={tmp_path}")
    assert len(read) == 1


def test_version_is_that_of_loopgap(monkeypatch, capsys):
    assert loopgap(monkeypatch, "--version") == 0
    assert capsys.readouterr().out.startswith(f"loopgap {metadata.version('loopgap')}")


def test_options_may_stand_between_overrides(tmp_path, monkeypatch, capsys):
    (tmp_path / "conf" / "training").mkdir(parents=True)
    (tmp_path / "conf" / "training" / "mine.yaml").write_text("reg_covar: 0.125\n")
    asked = ["seed=7", "--config-dir", str(tmp_path / "conf"), "training=mine"]
    assert loopgap(monkeypatch, *asked, "--cfg", "job") == 0
    said = capsys.readouterr().out
    assert "seed: 7" in said
    assert "0.125" in said


def test_a_sweep_with_a_configuration_of_ones_own(tmp_path, monkeypatch, capsys):
    (tmp_path / "conf" / "importing").mkdir(parents=True)
    (tmp_path / "conf" / "importing" / "mine.yaml").write_text(
        "tables: {log: {time: {column: t}, channels:"
        " {a_command_deg: {column: u, role: command, unit: deg}}}}"
    )
    (tmp_path / "log.csv").write_text("t,u\n" + "".join(f"{k},{k % 7}\n" for k in range(30)))
    asked = ["stages=[importing]", "-m", "seed=1,2", "--config-dir", str(tmp_path / "conf"), BASIC,
             "importing=mine", f"importing.path={tmp_path}/log.csv"]  # fmt: skip
    assert loopgap(monkeypatch, *asked, f"hydra.sweep.dir={tmp_path}/out") == 0
    assert "2 done, 0 failed, 0 left" in capsys.readouterr().out


@pytest.mark.parametrize("told", ["command line", "file"])
def test_a_sweep_may_be_asked_for_by_its_mode(told, tmp_path, monkeypatch, capsys):
    (tmp_path / "conf" / "experiment").mkdir(parents=True)
    (tmp_path / "conf" / "experiment" / "mine.yaml").write_text(
        "# @package _global_\nhydra: {mode: MULTIRUN}\n"
    )
    asked = {"command line": ["hydra.mode=MULTIRUN"],
             "file": ["--config-dir", str(tmp_path / "conf"), "experiment=mine"]}  # fmt: skip
    loopgap(monkeypatch, "stages=[none]", "seed=1,2", BASIC, f"hydra.sweep.dir={tmp_path}/out",
            *asked[told])  # fmt: skip
    assert "job 1: configuration, stages: expected" in "".join(capsys.readouterr())


def test_an_error_comes_first_and_then_how_to_go_on(tmp_path, monkeypatch, capsys):
    arguments = ["stages=[diagnosis]", f"recording={tmp_path}/none", f"hydra.run.dir={tmp_path}"]
    assert loopgap(monkeypatch, *arguments) == 1
    first, *rest = capsys.readouterr().err.splitlines()
    assert first.startswith(f"loopgap: {tmp_path}/none/recording.json: expected")
    assert rest[0] == "When its cause is gone, this goes on:"
    assert rest[1].startswith("  loopgap 'stages=[diagnosis]'")


def test_a_stage_without_its_input_says_which_stage_makes_it(tmp_path, monkeypatch, capsys):
    assert loopgap(monkeypatch, "stages=[training]", f"hydra.run.dir={tmp_path}") == 2
    assert "Add 'vision' to `stages`" in capsys.readouterr().err
    for name in ("job.json", "provenance.json"):
        assert json.loads((tmp_path / name).read_text())["status"] == "failed"


def test_sweep_shares_the_recording_and_leaves_one_table(small_run, tmp_path, monkeypatch):
    arguments = ["-m", *SMALL, BASIC, f"earlier={small_run}", f"hydra.sweep.dir={tmp_path}", LATER,
                 "selection.k=2,3", "split.index=0,1",
                 "compensation/step_rule=armijo,newton", "evaluation.trial=false"]  # fmt: skip
    assert loopgap(monkeypatch, *arguments) == 0
    results = pd.read_csv(tmp_path / "results.csv")
    assert results["job"].nunique() == 8
    assert set(results["selection.k"]) == {2, 3}
    assert set(results["compensation/step_rule"]) == {"armijo", "newton"}
    rmse = results[results["metric"] == "model_rmse"].groupby("split.index")["value"].mean()
    assert rmse[0] != rmse[1]


def test_second_job_of_a_sweep_uses_the_first_ones_frames(tmp_path, monkeypatch):
    arguments = ["-m", *SMALL, BASIC, "acquisition.cycles=1", f"hydra.sweep.dir={tmp_path}",
                 "stages=[acquisition,vision]", "training.n_init=1,2"]  # fmt: skip
    assert loopgap(monkeypatch, *arguments) == 0
    assert (tmp_path / "0" / "vision").is_dir()
    assert not (tmp_path / "1" / "vision").exists()
    assert [f.name[:6] for f in (tmp_path / "shared").glob("vision-*")] == ["vision"]


def test_a_failed_job_does_not_stop_the_others(small_run, tmp_path, monkeypatch, capsys):
    arguments = ["-m", *SMALL, BASIC, f"earlier={small_run}", f"hydra.sweep.dir={tmp_path}", LATER,
                 "selection.k=2,9999", "evaluation.trial=false"]  # fmt: skip
    assert loopgap(monkeypatch, *arguments) == 1
    results = pd.read_csv(tmp_path / "results.csv")
    assert set(results["selection.k"]) == {2}
    assert "at most" in (tmp_path / "results.md").read_text()


@pytest.mark.parametrize(
    ("argument", "words"),
    [
        ("selection.kk=4", "Key 'kk' is unknown under 'selection'; it may be: criterion,"),
        ("+selection.kk=4", "Key 'kk' is unknown under 'selection'; it may be: criterion,"),
        ("+kk=4", "Key 'kk' is unknown at the top"),
        ("hydra.run.dir=out/Größe 3", "Quote a value with letters such as ä twice"),
        ("selectoin.k=4", "Did you mean 'selection'?"),
        ("selection.k=many", "selection.k takes a whole number or null"),
        ("acquisition.cycles=nine", "acquisition.cycles takes a whole number"),
        ("compensation/step_rule=wolfe", "armijo"),
        ("compensation.step_rule.shrinc=0.5", "Key 'shrinc' is unknown"),
        ("robot=kuka", "emulated"),
        ("stages=[aquisition]", "one of acquisition, vision"),
        ("selection.criterion=cv", "one of bic, aic, heldout"),
        ("diagnosis.tolerance.gain=-0.1", "a number of at least 0"),
        ("selection.k=4=5", "selection.k"),
        ("acquisition.amplitude_deg.yaw=far", "amplitude_deg takes a mapping of names, each to a"),
        ("selection.k=-3", "selection.k: expected a number of at least 1; found -3"),
        ("seed=-1", "seed: expected a number of at least 0"),
        ("acquisition.pause_s=-3", "acquisition.pause_s: expected a number of at least 0"),
        ("compensation.step_rule.shrink=1", "shrink: expected a number below 1"),
        ("acquisition.cycles=3", "split: expected at least 4 cycles; found 3"),
        ("diagnosis.cutoff_hz=0", "cutoff_hz: expected a number above 0; found 0.0"),
        ("earlier=/no/such", "earlier=/no/such: expected the folder of an earlier run"),
        ("diagnosis", "found a stage. Say stages=[diagnosis]."),
    ],
)
def test_wrong_configuration_names_the_key_and_what_it_may_be(
    argument, words, tmp_path, monkeypatch, capsys
):
    assert loopgap(monkeypatch, argument, f"hydra.run.dir={tmp_path}") == 2
    assert words in capsys.readouterr().err


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("{a: b: c}", "importing/mine.yaml, line 2: expected YAML; found expected ','"),
        (
            "{channels: {angle: {roll: x}}}",
            "under 'importing.tables.log.channels.angle'; it may be",
        ),
    ],
)
def test_a_wrong_mapping_of_ones_own_says_where(text, words, tmp_path, monkeypatch, capsys):
    (tmp_path / "importing").mkdir()
    (tmp_path / "importing" / "mine.yaml").write_text(f"source: x\ntables: {{log: {text}}}\n")
    assert loopgap(monkeypatch, "--config-dir", str(tmp_path), "importing=mine") == 2
    assert words in capsys.readouterr().err


@pytest.mark.skipif(find_spec("ray") is not None, reason="Ray is installed")
def test_a_launcher_that_is_not_installed_says_how_to_come_by_it(tmp_path, monkeypatch, capsys):
    arguments = ["-m", "hydra/launcher=ray", "stages=[]", f"hydra.sweep.dir={tmp_path}"]
    assert loopgap(monkeypatch, *arguments) == 2
    assert "pip install '.[ray]'" in capsys.readouterr().err


def test_output_folder_that_cannot_be_made(tmp_path, monkeypatch, capsys):
    (tmp_path / "file").write_text("")
    assert loopgap(monkeypatch, f"hydra.run.dir={tmp_path}/file/run") == 1
    assert "expected a place that can be written; found Not a directory" in capsys.readouterr().err


def test_absent_serial_port(tmp_path, monkeypatch, capsys):
    arguments = ["robot=epos2", "robot.port=/dev/ttyNOT", "camera=v4l2", "acquisition.clock=real"]
    assert loopgap(monkeypatch, *arguments, f"hydra.run.dir={tmp_path}") == 1
    assert "/dev/ttyNOT" in capsys.readouterr().err


def test_real_robot_needs_a_real_camera(tmp_path, monkeypatch, capsys):
    assert loopgap(monkeypatch, "robot=epos2", f"hydra.run.dir={tmp_path}") == 2
    assert "camera=v4l2" in capsys.readouterr().err


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_interrupted_acquisition_leaves_a_readable_recording(number, tmp_path):
    command = [sys.executable, "-m", "pipeline.app", "stages=[acquisition]",
               f"hydra.run.dir={tmp_path}"]  # fmt: skip
    process = subprocess.Popen(
        command, cwd=ROOT, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True,
        env=os.environ | {"PYTHONUNBUFFERED": "1"},
    )  # fmt: skip
    samples = tmp_path / "acquisition" / "yaw" / "samples.csv"
    deadline = time.monotonic() + 60
    while not (samples.is_file() and samples.read_text().count("\n") > 10):
        assert time.monotonic() < deadline
        assert process.poll() is None
        time.sleep(0.05)
    process.send_signal(number)
    _, errors = process.communicate(timeout=60)
    assert process.returncode == app.INTERRUPTED
    assert "interrupted" in errors
    recording = load_recording(samples.parent)
    frames = list((samples.parent / "frames").glob("yaw_*.jpg"))
    assert 10 <= len(recording.samples) <= len(frames) <= len(recording.samples) + 1
    truth = pd.read_csv(tmp_path / "acquisition" / "truth" / "yaw.csv")
    assert len(recording.samples) - 1 <= len(truth) <= len(recording.samples)

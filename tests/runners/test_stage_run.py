"""When a stage is run, and when its result is taken from where it is already."""

import json
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from pipeline.config import (
    CameraConfig,
    Config,
    RobotConfig,
    SelectionConfig,
    SplitConfig,
    TrainingConfig,
)
from pipeline.runners.contracts import contract_of, may_be_reused
from pipeline.runners.run_folder import Run
from pipeline.runners.stage_run import Workplace, _clear, do_stage, inputs_of, key_of
from pipeline.tracking.cache import StageCache
from pipeline.tracking.stage_record import begin

DATA = Path(__file__).resolve().parents[2] / "data" / "paper_twin"
EMULATED = Config(
    robot=RobotConfig(kind="emulated"), camera=CameraConfig(kind="twin"),
    split=SplitConfig(kind="paper"), selection=SelectionConfig(k=1),
    training=TrainingConfig(n_init=1), stages=["training"],
)  # fmt: skip
Changed = Callable[[Config], Config]


@pytest.fixture
def earlier(tmp_path: Path) -> Path:
    shutil.copytree(DATA, tmp_path / "earlier" / "vision")
    return tmp_path / "earlier"


@pytest.fixture
def place(tmp_path: Path) -> Workplace:
    return Workplace(StageCache(tmp_path / "cache"), None, lambda: None)


def run_in(folder: Path, earlier: Path, config: Config = EMULATED) -> Run:
    folder.mkdir(exist_ok=True)
    return Run(config, folder, earlier)


def key(run: Run, stage: str = "training") -> str:
    contract = contract_of(stage, run.config)
    return key_of(run, stage, contract, inputs_of(run, stage, contract))


def test_a_stage_runs_once_then_comes_from_the_cache_or_is_there(
    tmp_path: Path, earlier: Path, place: Workplace
) -> None:
    first = do_stage(run_in(tmp_path / "a", earlier), "training", place)
    again = do_stage(run_in(tmp_path / "a", earlier), "training", place)
    other = do_stage(run_in(tmp_path / "b", earlier), "training", place)
    assert [r.made for r in (first, again, other)] == ["ran", "before", "cache"]
    assert first.outputs == again.outputs == other.outputs
    assert other.said == first.said == "  cycles [0, 1, 2, 3, 4, 5] train, [6, 7, 8] test\n"
    for name in ("yaw", "pitch"):
        model = (tmp_path / "b" / "training" / f"{name}.json").read_bytes()
        assert model == (tmp_path / "a" / "training" / f"{name}.json").read_bytes()


def test_a_result_that_was_changed_in_the_run_is_made_good(
    tmp_path: Path, earlier: Path, place: Workplace, capsys: pytest.CaptureFixture[str]
) -> None:
    do_stage(run_in(tmp_path / "a", earlier), "training", place)
    file = tmp_path / "a" / "training" / "yaw.json"
    whole = file.read_bytes()
    file.write_text("{}")
    assert do_stage(run_in(tmp_path / "a", earlier), "training", place).made == "cache"
    assert file.read_bytes() == whole
    assert "have changed since" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("change", "same"),
    [
        (lambda c: replace(c, seed=1), False),
        (lambda c: replace(c, training=replace(c.training, n_init=2)), False),
        (lambda c: replace(c, split=replace(c.split, index=1)), False),
        (lambda c: replace(c, evaluation=replace(c.evaluation, tip_length_mm=4.0)), True),
        (lambda c: replace(c, vision=replace(c.vision, workers=1)), True),
        (lambda c: replace(c, stages=["training", "compensation"]), True),
    ],
)
def test_only_what_decides_on_a_result_is_in_its_key(
    change: Changed, same: bool, tmp_path: Path, earlier: Path
) -> None:
    before = key(run_in(tmp_path / "a", earlier))
    assert (key(run_in(tmp_path / "b", earlier, change(EMULATED))) == before) is same


def test_a_changed_sample_changes_the_key_and_a_moved_recording_does_not(
    tmp_path: Path, earlier: Path
) -> None:
    before = key(run_in(tmp_path / "a", earlier))
    moved = earlier.rename(tmp_path / "moved")
    assert key(run_in(tmp_path / "a", moved)) == before
    samples = moved / "vision" / "yaw" / "samples.csv"
    samples.write_text(samples.read_text().replace("0,0,0.3", "0,0,0.4", 1) + "\n")
    assert key(run_in(tmp_path / "a", moved)) != before


@pytest.mark.parametrize("stage", ["acquisition", "evaluation", "close_the_gap"])
@pytest.mark.parametrize(
    "real",
    [
        lambda c: replace(c, robot=RobotConfig(kind="epos2", port="/dev/ttyS0")),
        lambda c: replace(c, camera=CameraConfig(kind="v4l2")),
        lambda c: replace(c, camera=CameraConfig(kind="folder")),
        lambda c: replace(c, acquisition=replace(c.acquisition, clock="real")),
    ],
)
def test_what_hardware_did_is_never_reused(stage: str, real: Changed) -> None:
    assert may_be_reused(stage, EMULATED)
    assert not may_be_reused(stage, real(EMULATED))
    assert may_be_reused("training", real(EMULATED))


@pytest.mark.parametrize(("source", "kept"), [("real", True), ("simulated", False)])
def test_a_half_done_recording_of_a_real_robot_is_set_aside(
    source: str, kept: bool, tmp_path: Path, place: Workplace
) -> None:
    config = replace(
        EMULATED, acquisition=replace(EMULATED.acquisition, cycles=1, steps_per_cycle=4),
        camera=CameraConfig(kind="twin", width_px=252, height_px=189),
    )  # fmt: skip
    run = run_in(tmp_path / "a", tmp_path, config)
    half = run.folder / "acquisition" / "yaw"
    half.mkdir(parents=True)
    (half / "recording.json").write_text(json.dumps({"source": source}))
    (run.folder / ".stages").mkdir()
    (run.folder / ".stages" / "acquisition.begun").touch()
    assert do_stage(run, "acquisition", place).made == "ran"
    assert (run.folder / "set_aside-1" / "acquisition" / "yaw").is_dir() is kept
    assert json.loads((half / "recording.json").read_text())["schema"]


def test_a_half_done_diagnosis_leaves_no_copies_behind(
    tmp_path: Path, earlier: Path, place: Workplace
) -> None:
    run = run_in(tmp_path / "a", earlier)
    begin(run.folder, "diagnosis")
    copy = run.folder / "diagnosis" / "mine"
    copy.mkdir(parents=True)
    (copy / "recording.json").write_text('{"source": "my robot"}')
    _clear(run.folder, "diagnosis", contract_of("diagnosis", run.config))
    assert not copy.exists()
    assert not (run.folder / "set_aside-1").exists()


def test_files_of_somebody_else_are_set_aside(
    tmp_path: Path, earlier: Path, place: Workplace, capsys: pytest.CaptureFixture[str]
) -> None:
    run = run_in(tmp_path / "a", earlier)
    (run.folder / "training").mkdir()
    (run.folder / "training" / "notes.txt").write_text("mine")
    do_stage(run, "training", place)
    assert (run.folder / "set_aside-1" / "training" / "notes.txt").read_text() == "mine"
    assert "set_aside-1" in capsys.readouterr().err

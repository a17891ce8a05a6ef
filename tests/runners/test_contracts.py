"""A stage looks at no setting, and leaves no file, that its contract does not name."""

import dataclasses
import shutil
from pathlib import Path
from typing import Any

import pytest

from pipeline.config import (
    EXTRA_STAGES,
    STAGES,
    CameraConfig,
    CompensationConfig,
    Config,
    CrossedConfig,
    EvaluationConfig,
    RobotConfig,
    SelectionConfig,
    SplitConfig,
    TrainingConfig,
)
from pipeline.runners.contracts import contract_of
from pipeline.runners.run_folder import Run
from pipeline.tracking.hashes import files_matching

DATA = Path(__file__).resolve().parents[2] / "data" / "paper_twin"
PLACES = {"recording", "earlier", "model"}  # whose content counts, as inputs
SMALL = Config(
    robot=RobotConfig(kind="emulated"), camera=CameraConfig(kind="twin"),
    split=SplitConfig(kind="paper"), selection=SelectionConfig(k_max=2, n_init=1, scores=["bic"]),
    training=TrainingConfig(n_init=1), compensation=CompensationConfig(targets=4),
    evaluation=EvaluationConfig(trial=False), crossed=CrossedConfig(ks=[1]),
)  # fmt: skip


def watched(config: Any, seen: set[str], prefix: str = "") -> Any:
    """The same configuration; each key that is looked at is noted, sections by their keys."""
    names = {f.name for f in dataclasses.fields(config)}

    def look(self: Any, name: str) -> Any:
        value = super(kind, self).__getattribute__(name)
        if name in names and not dataclasses.is_dataclass(value):
            seen.add(f"{prefix}{name}")
        return value

    kind = type(type(config).__name__, (type(config),), {"__getattribute__": look})
    values = {
        name: watched(value, seen, f"{prefix}{name}.") if dataclasses.is_dataclass(value) else value
        for name, value in ((n, getattr(config, n)) for n in names)
    }
    return kind(**values)


def undeclared(seen: set[str], settings: tuple[str, ...]) -> list[str]:
    """Keys that were looked at without being declared; the outer section declares its inner."""
    return sorted(
        key
        for key in seen - PLACES
        if key not in settings and key.partition(".")[0] not in settings
    )


def test_stages_look_at_and_leave_what_they_declare(tmp_path: Path) -> None:
    folder = tmp_path / "run"
    shutil.copytree(DATA, folder / "vision")
    for stage in ("selection", "training", "compensation", "evaluation", "fits", "crossed"):
        before, seen = set(files_matching(folder, ["*"])), set[str]()
        contract = contract_of(stage, SMALL)
        contract.function()(Run(watched(SMALL, seen), folder))
        assert seen, stage
        assert undeclared(seen, contract.settings) == [], stage
        left = set(files_matching(folder, ["*"])) - before
        assert left == set(files_matching(folder, contract.leaves)), stage
        assert left


@pytest.mark.parametrize("stage", [*STAGES, *EXTRA_STAGES])
def test_every_stage_has_a_contract_whose_settings_exist(stage: str) -> None:
    for key in contract_of(stage, SMALL).settings:
        section, _, name = key.partition(".")
        value = getattr(SMALL, section)
        assert not name or hasattr(value, name)


def test_a_setting_that_is_not_declared_is_found(tmp_path: Path) -> None:
    seen: set[str] = set()
    config = watched(SMALL, seen)
    assert config.compensation.step_rule.initial == 1.0
    assert undeclared(seen, ("seed",)) == ["compensation.step_rule.initial"]

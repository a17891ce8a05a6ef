import numpy as np
import pytest
from play_loop import play_recording

from pipeline.config import CompensationConfig, TrainingConfig
from pipeline.errors import UsageError
from pipeline.models.loop_model import MODELS, LoopModel
from pipeline.stages.compensation import compensate

COLUMNS = ["method", "target_deg", "command_deg", "model_deg", "direction", "status", "iterations"]


@pytest.fixture(scope="module")
def models() -> dict[str, LoopModel]:
    def fit(axis: str, width: float) -> LoopModel:
        recording = play_recording(axis, width, 0.3, seed=2, steps=100)
        k = dict.fromkeys(MODELS, 3)
        return LoopModel.fit(recording, axis, range(6), k, TrainingConfig(n_init=2), seed=0)

    return {"yaw": fit("yaw", 1.0), "pitch": fit("pitch", 2.0)}


def test_both_methods_get_a_command_and_a_status_for_every_target(
    models: dict[str, LoopModel],
) -> None:
    tables = compensate(CompensationConfig(targets=40), models)
    assert set(tables) == {"yaw", "pitch"}
    for table in tables.values():
        assert list(table.columns) == COLUMNS
        assert table["method"].value_counts().to_dict() == {"compensated": 40, "nominal": 40}
        assert (table["status"] == "converged").all()
        assert (table["model_deg"] - table["target_deg"]).abs().max() <= 1e-6


def test_loop_is_crossed_in_the_command_and_ignored_by_the_nominal(
    models: dict[str, LoopModel],
) -> None:
    """At one angle the command is ahead by twice the play between the two directions."""
    table = compensate(CompensationConfig(targets=80), models)["pitch"]
    width = {}
    for method, rows in table.groupby("method"):
        target = rows["target_deg"].to_numpy().round(9)
        inner = np.abs(target) < 20.0
        rising, falling = (
            dict(zip(target[s], rows["command_deg"].to_numpy()[s], strict=True))
            for s in (inner & (rows["direction"] == 1), inner & (rows["direction"] == -1))
        )
        common = sorted(set(rising) & set(falling))
        assert len(common) > 10
        width[method] = np.mean([rising[t] - falling[t] for t in common])
    assert width["compensated"] == pytest.approx(4.0, abs=0.3)
    assert width["nominal"] == pytest.approx(0.0, abs=1e-5)


def test_algorithm_as_printed_leaves_every_target_at_home(models: dict[str, LoopModel]) -> None:
    config = CompensationConfig(algorithm="as_printed", targets=12)
    table = compensate(config, models)["yaw"]
    printed = table[table["method"] == "compensated"]
    assert (printed["command_deg"] == 0.0).all()
    assert (printed["status"] == "no_branch").all()
    assert (table[table["method"] == "nominal"]["status"] == "converged").all()


def test_targets_beyond_the_robot_are_said_to_be_unreachable(models: dict[str, LoopModel]) -> None:
    config = CompensationConfig(targets=40, target_amplitude_deg=80.0)
    table = compensate(config, models)["pitch"]
    far = table["target_deg"].abs() > 46.0
    assert (table.loc[far, "status"] == "unreachable").all()
    assert table["command_deg"].abs().max() <= 60.0


def test_unknown_algorithm_is_refused(models: dict[str, LoopModel]) -> None:
    with pytest.raises(UsageError, match="compensation.algorithm: .*found 'newest'"):
        compensate(CompensationConfig(algorithm="newest"), models)

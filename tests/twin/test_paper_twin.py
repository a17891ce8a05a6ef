"""The default twin leaves the model errors that the paper reports."""

from pathlib import Path

import numpy as np
import pytest
from omegaconf import OmegaConf

from pipeline.config import AcquisitionConfig, TrainingConfig, TwinConfig
from pipeline.models.loop_model import LoopModel
from pipeline.recording import Channel, Recording, branch_of
from pipeline.stages.acquisition import protocol
from pipeline.twin.snake import Snake

CONF = Path(__file__).resolve().parents[2] / "conf" / "twin"
VISION_ERROR_DEG = 0.035
SEEDS = range(5)
PAPER = {  # axis: K, nominal and split error, each with what it may be off
    "yaw": (9, (1.01, 0.10), (0.39, 0.04)),
    "pitch": (11, (1.73, 0.10), (0.47, 0.04)),
}


def twin(name: str) -> TwinConfig:
    config = OmegaConf.merge(OmegaConf.structured(TwinConfig), OmegaConf.load(CONF / name))
    return OmegaConf.to_object(config)


def recorded(config: TwinConfig, axis: str, seed: int) -> Recording:
    """The paper's nine cycles; vision's own error is drawn in place of rendering the frames."""
    samples = protocol(AcquisitionConfig(), axis)
    samples["time_s"] = 3.0 * np.arange(1, len(samples) + 1)
    snake, angle_deg = Snake(config, seed), []
    for row in samples.itertuples():
        snake.move(row.time_s, {"yaw": row.yaw_command_deg, "pitch": row.pitch_command_deg})
        angle_deg.append(snake.seen_deg()[axis])
    rng = np.random.default_rng(1000 + seed)
    samples[f"{axis}_angle_deg"] = angle_deg + VISION_ERROR_DEG * rng.standard_normal(len(samples))
    command = Channel(f"{axis}_command_deg", "command", "deg")
    return Recording(samples, (command, Channel(f"{axis}_angle_deg", "measurement", "deg")))


def rmse_deg(errors_deg: np.ndarray) -> float:
    return float(np.sqrt(np.mean(errors_deg**2)))


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("axis", PAPER)
def test_nominal_and_split_errors_are_the_papers(axis, seed):
    k, nominal, split = PAPER[axis]
    recording = recorded(twin("paper.yaml"), axis, seed)
    ks = dict.fromkeys(("nominal", "cw", "ccw"), k)
    model = LoopModel.fit(recording, axis, range(6), ks, TrainingConfig(n_init=2), seed)
    test = recording.cycles([6, 7, 8])
    command_deg, angle_deg = test.values(f"{axis}_command_deg"), test.values(f"{axis}_angle_deg")
    direction = branch_of(recording.values(f"{axis}_command_deg"))[-len(command_deg) :]
    nominal_deg = rmse_deg(model.predict(command_deg, 0)[0] - angle_deg)
    split_deg = rmse_deg(model.predict(command_deg, direction)[0] - angle_deg)
    assert nominal_deg == pytest.approx(nominal[0], abs=nominal[1])
    assert split_deg == pytest.approx(split[0], abs=split[1])
    assert angle_deg.max() == pytest.approx(45.0, abs=1.5)
    assert angle_deg.min() == pytest.approx(-45.0, abs=1.5)

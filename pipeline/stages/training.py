"""Training: the nominal, cw and ccw mixtures of every axis."""

from collections.abc import Mapping, Sequence

from pipeline.config import TrainingConfig
from pipeline.models.loop_model import LoopModel
from pipeline.recording import Recording


def train(
    config: TrainingConfig,
    recordings: Mapping[str, Recording],
    train_cycles: Sequence[int],
    chosen: Mapping[str, Mapping[str, int]],
    seed: int,
) -> dict[str, LoopModel]:
    """A loop model for each axis, fitted to the training cycles; `chosen` is axis -> model -> K."""
    return {
        axis: LoopModel.fit(recording, axis, train_cycles, chosen[axis], config, seed)
        for axis, recording in recordings.items()
    }

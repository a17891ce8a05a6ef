"""Compensation: commands for a path of desired angles, with hysteresis known and without."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict

import numpy as np
import pandas as pd

from pipeline.config import CompensationConfig
from pipeline.control.as_printed import follow_as_printed
from pipeline.control.inverse import Solution, follow, loop_branches, nominal_branches
from pipeline.control.trial import trial_path
from pipeline.models.loop_model import LoopModel

CORRECTED = "corrected"


def compensate(
    config: CompensationConfig, models: Mapping[str, LoopModel]
) -> dict[str, pd.DataFrame]:
    """Commands along the trial path for each axis (`command_table`)."""
    targets = trial_path(config.targets, config.target_amplitude_deg)
    return {axis: command_table(config, model, targets) for axis, model in models.items()}


def command_table(
    config: CompensationConfig, model: LoopModel, targets_deg: np.ndarray
) -> pd.DataFrame:
    """Commands of both methods for desired angles [deg], shape (n,), one row each.

    Columns: method, target_deg, command_deg, model_deg (the model's angle at that command),
    direction (+1 ascending), status, iterations. `compensated` is searched on the loop's branches
    (a reading of the printed algorithm stands under its own name), `nominal` on the one curve that
    knows no hysteresis. Both start at home.
    """
    targets = [float(target) for target in targets_deg]
    if config.algorithm == CORRECTED:
        method, solutions = "compensated", follow(loop_branches(model), targets, config)
    else:
        method, solutions = config.algorithm, follow_as_printed(model, targets, config)
    nominal = follow(nominal_branches(model), targets, config)
    return pd.concat([_rows(method, solutions), _rows("nominal", nominal)],
                     ignore_index=True)  # fmt: skip


def compensated_commands(config: CompensationConfig, model: LoopModel) -> pd.DataFrame:
    """The part of `command_table` that knows hysteresis, along the trial path."""
    targets = [float(t) for t in trial_path(config.targets, config.target_amplitude_deg)]
    return _rows("compensated", follow(loop_branches(model), targets, config))


def _rows(method: str, solutions: Sequence[Solution]) -> pd.DataFrame:
    table = pd.DataFrame([asdict(solution) for solution in solutions])
    columns = ["target_deg", "command_deg", "model_deg", "direction", "status", "iterations"]
    return table[columns].assign(method=method)[["method", *columns]]

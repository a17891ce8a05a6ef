"""Baselines: what models without a mechanism reach on the rows that a diagnosis holds out."""

import numpy as np
import pandas as pd

from pipeline.config import DiagnosisConfig
from pipeline.discrepancy.problem import Problem, pose_problem
from pipeline.models.baselines import MODELS, Predict, linear, offset_and_gain, strongest_first
from pipeline.recording import Recording
from pipeline.stages.diagnosis import simulated

AS_IT_CAME, REFITTED = "simulation as it came", "offset and gain"
LINEAR_AND_TIME = "linear in all commands and time"


def compare(config: DiagnosisConfig, recording: Recording) -> pd.DataFrame:
    """`measurement`, `model`, train and held-out RMSE, and unit: a row for each model.

    All are fitted to the rows that the diagnosis may fit to, outliers among them, and judged on
    the rows that it holds out. Every measurement needs its simulation channel.
    """
    rows = []
    for channel in recording.with_role("measurement"):
        problem = pose_problem(config, recording, channel.name, simulated(recording, channel.name))
        for name, answer in answers(problem, recording):
            train, heldout = root_means(problem, answer)
            rows.append((channel.name, name, train, heldout, channel.unit))
    columns = ["measurement", "model", "train RMSE", "held-out RMSE", "unit"]
    return pd.DataFrame(rows, columns=columns)


def answers(problem: Problem, recording: Recording) -> list[tuple[str, np.ndarray]]:
    """Name and answer (n,) of every baseline that these commands allow."""
    train = problem.train
    measured = np.where(np.isfinite(problem.measured), problem.measured, 0.0)
    came = np.where(np.isfinite(problem.simulated), problem.simulated, 0.0)
    commands = [recording.values(c.name) for c in recording.with_role("command")]
    ranked = strongest_first(commands, measured, train)
    out = [(AS_IT_CAME, came)]
    trials: list[tuple[str, Predict, np.ndarray]] = [(REFITTED, offset_and_gain, came)]
    if ranked.shape[1]:
        seconds = problem.motion.time_s - problem.motion.time_s[0]
        trials.append((LINEAR_AND_TIME, linear, np.column_stack([ranked, seconds])))
        trials += [(model.name, model.predict, ranked) for model in MODELS]
    out += [(name, predict(inputs, measured, train)) for name, predict, inputs in trials]
    return out


def root_means(problem: Problem, answer: np.ndarray) -> tuple[float, float]:
    """Root mean square error on the rows to fit on and on the held-out ones."""
    square = (problem.measured - answer) ** 2
    return tuple(float(np.sqrt(np.mean(square[r]))) for r in (problem.train, problem.heldout))  # type: ignore[return-value]

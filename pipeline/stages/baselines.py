"""Baselines: what models without a mechanism reach on the rows that a diagnosis holds out."""

from functools import partial

import numpy as np
import pandas as pd

from pipeline.config import DiagnosisConfig
from pipeline.discrepancy.problem.posing import pose_problem
from pipeline.discrepancy.problem.problem import Problem
from pipeline.models.baselines import (
    MODELS,
    TIMED_MODELS,
    Predict,
    offset_and_gain,
    strongest_first,
)
from pipeline.recording import Recording
from pipeline.stages.comparison import comparison
from pipeline.stages.diagnosis import simulated

AS_IT_CAME, REFITTED = "simulation as it came", "offset and gain"


def compare(config: DiagnosisConfig, recording: Recording) -> pd.DataFrame:
    """`measurement`, `model`, train and held-out RMSE, and unit: a row for each model.

    All are fitted to the rows that the diagnosis may fit to, outliers among them, and judged on
    the rows that it holds out. Every measurement needs its simulation channel.
    """
    tables = []
    for channel in recording.with_role("measurement"):
        problem = pose_problem(config, recording, channel.name, simulated(recording, channel.name))
        judged = {
            "train RMSE": partial(root_mean_square, problem, problem.train),
            "held-out RMSE": partial(root_mean_square, problem, problem.heldout),
        }
        table = comparison(answers(problem, recording), judged)
        table.insert(0, "measurement", channel.name)
        tables.append(table.assign(unit=channel.unit))
    return pd.concat(tables, ignore_index=True)


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
        timed = np.column_stack([ranked, seconds])
        trials += [(model.name, model.predict, ranked) for model in MODELS]
        trials += [(model.name, model.predict, timed) for model in TIMED_MODELS]
    out += [(name, predict(inputs, measured, train)) for name, predict, inputs in trials]
    return out


def root_mean_square(problem: Problem, rows: np.ndarray, answer: np.ndarray) -> float:
    """Root mean square error of an answer (n,) over some rows, a mask (n,)."""
    return float(np.sqrt(np.mean((problem.measured - answer)[rows] ** 2)))

"""Evaluation: how far the models, and the robot that follows them, are from the measured angle.

Angles are in degrees. The tip of a bending section of length L stands on a circle about its base,
so that an angle error e puts it a chord of 2 L sin(|e| / 2) beside its place.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from pipeline.config import EvaluationConfig
from pipeline.errors import LoopgapError, refusal
from pipeline.models.loop_model import LoopModel
from pipeline.recording import Channel, Recording, branch_of
from pipeline.tracking.tables import METRIC_COLUMNS

UM_PER_MM = 1000.0
NORMAL_95 = 1.959964
COMMAND_TOLERANCE_DEG = 1e-6
JUDGES = {"camera": "measured_deg", "true": "true_deg"}

Row = tuple[str, str, int | None, str, float, str, int]


@dataclass(frozen=True)
class Evaluation:
    """`metrics` has one number a row (`METRIC_COLUMNS`); the other two lay them out for reading."""

    metrics: pd.DataFrame
    table: pd.DataFrame
    closed_loop: pd.DataFrame


def evaluate(
    config: EvaluationConfig,
    predictions: Mapping[str, pd.DataFrame],
    landings: Mapping[str, Mapping[str, pd.DataFrame]],
    commands: Mapping[str, Mapping[str, pd.DataFrame]] | None = None,
) -> Evaluation:
    """Score every axis's predictions (`predict_cycles`) and landings (axis -> method -> `land`).

    A prediction is scored as a whole (no `cycle`) and for each of its cycles. `commands`, axis ->
    method -> a part of `command_table`, is scored without a robot; where it is not given, what is
    known of the landings' commands. `n` is the number of samples that a value stands on; samples
    without a measurement are counted in the metric `not_measured` of their method.
    """
    tip_mm = config.tip_length_mm
    rows: list[Row] = []
    for axis, prediction in predictions.items():
        rows += _model_rows(axis, None, prediction, tip_mm)
        for cycle in prediction["cycle"].unique().tolist():
            part = prediction[prediction["cycle"] == cycle]
            rows += _model_rows(axis, cycle, part, tip_mm)
    for axis, of_methods in landings.items():
        rows += _landing_rows(axis, of_methods, tip_mm)
    for axis, of_methods in (landings if commands is None else commands).items():
        for method, table in of_methods.items():
            rows += command_rows(axis, method, table)
    metrics = pd.DataFrame(rows, columns=list(METRIC_COLUMNS)).astype({"cycle": "Int64"})
    return Evaluation(metrics, paper_table(metrics), closed_loop_table(metrics))


def predict_cycles(model: LoopModel, recording: Recording, cycles: Sequence[int]) -> pd.DataFrame:
    """What nominal and compensated model say of some cycles, a row for each of their samples.

    Columns: time_s, cycle, step, direction (+1 ascending), command_deg, measured_deg (NaN where
    not measured), nominal_deg, nominal_std_deg, compensated_deg, compensated_std_deg. Directions
    are taken from the whole recording, so that the first sample of a cycle knows its branch.
    """
    directed = recording.with_channel(
        Channel("direction", "other", "1"), branch_of(recording.values(model.command))
    )
    chosen = directed.cycles(cycles)
    command = chosen.values(model.command)
    direction = chosen.samples["direction"].to_numpy(int)
    nominal, nominal_std = model.nominal.predict(command)
    compensated, compensated_std = model.predict(command, direction)
    table = chosen.samples[["time_s", "cycle", "step", "direction"]].reset_index(drop=True)
    return table.assign(
        command_deg=command,
        measured_deg=chosen.values(model.measurement),
        nominal_deg=nominal,
        nominal_std_deg=nominal_std,
        compensated_deg=compensated,
        compensated_std_deg=compensated_std,
    )


def land(
    commands: pd.DataFrame, recording: Recording, truth: pd.DataFrame | None, axis: str
) -> pd.DataFrame:
    """Where the robot landed for each target: `commands` with measured_deg and true_deg.

    `commands` has target_deg, command_deg, status in the order of sending; a target without a
    command (NaN) was not sent and stays without a landing. `truth` has one row (`<axis>_true_deg`)
    for each of the recording's, or is None on a real robot. LoopgapError if the recording isn't
    the one of these commands.
    """
    sent = commands["command_deg"].notna().to_numpy()
    expected = commands.loc[sent, "command_deg"].to_numpy(float)
    found = recording.values(f"{axis}_command_deg")
    if len(found) != len(expected) or not np.allclose(found, expected, atol=COMMAND_TOLERANCE_DEG):
        raise LoopgapError(
            refusal(
                f"closed loop of {axis}",
                f"the {len(expected)} commands that were sent",
                f"{len(found)} samples of other commands",
                "Evaluate the recording that these commands made.",
            )
        )
    return commands.assign(
        measured_deg=_at(sent, recording.values(f"{axis}_angle_deg")),
        true_deg=_at(sent, None if truth is None else truth[f"{axis}_true_deg"].to_numpy(float)),
    )


def rms(values: np.ndarray) -> float:
    """Root of the mean square of the values that are there; NaN where none is."""
    finite = values[np.isfinite(values)]
    return float(np.sqrt(np.mean(finite**2))) if finite.size else float("nan")


def tip_error_um(error_deg: np.ndarray, tip_length_mm: float) -> np.ndarray:
    """Distance [um] of the tip from its place: the chord 2 L sin(|e| / 2), any shape."""
    return 2.0 * tip_length_mm * UM_PER_MM * np.sin(np.radians(np.abs(error_deg)) / 2.0)


def improvement_percent(before: float, after: float) -> float:
    """By how much `after` is smaller than `before`, in percent of `before`."""
    return 100.0 * (1.0 - after / before) if before > 0.0 else float("nan")


def travel_deg(command_deg: np.ndarray) -> float:
    """Way that commands (n,) make the shaft go, from the first on; unsent ones (NaN) don't move."""
    sent = command_deg[np.isfinite(command_deg)]
    return float(np.abs(np.diff(sent)).sum())


def shortest_travel_deg(target_deg: np.ndarray, command_deg: np.ndarray) -> float:
    """Least travel that the targets ask for: straight from one turn of the targets to the next.

    Between two turns the desired angle only rises or only falls, so nothing beyond the way between
    the commands at these turns is needed; whatever `travel_deg` has more was wasted.
    """
    sent = np.isfinite(command_deg)
    target, command = target_deg[sent], command_deg[sent]
    if len(target) == 0:
        return 0.0
    direction = branch_of(target)
    turns = np.flatnonzero(direction[1:] != direction[:-1])
    return travel_deg(command[np.unique([0, *turns, len(command) - 1])])


def _model_rows(axis: str, cycle: int | None, table: pd.DataFrame, tip_mm: float) -> list[Row]:
    measured = table["measured_deg"].to_numpy(float)
    n = int(np.isfinite(measured).sum())
    rows: list[Row] = []
    rmse_deg: dict[str, float] = {}
    for method in ("nominal", "compensated"):
        error = measured - table[f"{method}_deg"].to_numpy(float)
        inside = np.abs(error) <= NORMAL_95 * table[f"{method}_std_deg"].to_numpy(float)
        covered = 100.0 * float(inside.sum()) / n if n else float("nan")
        rmse_deg[method] = rms(error)
        rows += [
            (axis, method, cycle, "model_rmse", rmse_deg[method], "deg", n),
            (axis, method, cycle, "model_tip_rmse", rms(tip_error_um(error, tip_mm)), "um", n),
            (axis, method, cycle, "model_coverage_95", covered, "%", n),
            (axis, method, cycle, "model_not_measured", len(error) - n, "samples", len(error)),
        ]
    gained = improvement_percent(rmse_deg["nominal"], rmse_deg["compensated"])
    return [*rows, (axis, "compensated", cycle, "model_improvement", gained, "%", n)]


def _landing_rows(axis: str, landings: Mapping[str, pd.DataFrame], tip_mm: float) -> list[Row]:
    rows: list[Row] = []
    for method, landing in landings.items():
        for judge in JUDGES:
            error = _landing_error(landing, judge)
            n = int(np.isfinite(error).sum())
            if n == 0:
                continue
            tip_um = rms(tip_error_um(error, tip_mm))
            rows.append((axis, method, None, f"landing_rmse_{judge}", rms(error), "deg", n))
            rows.append((axis, method, None, f"landing_tip_rmse_{judge}", tip_um, "um", n))
            if method != "nominal" and "nominal" in landings:
                before = rms(_landing_error(landings["nominal"], judge))
                gained = improvement_percent(before, rms(error))
                rows.append((axis, method, None, f"landing_improvement_{judge}", gained, "%", n))
        missing = int(landing["measured_deg"].isna().sum())
        rows.append((axis, method, None, "landing_not_measured", missing, "targets", len(landing)))
    return rows


def command_rows(axis: str, method: str, table: pd.DataFrame) -> list[Row]:
    """What commands cost: travel, statuses and, where the search is told, iterations and error.

    `table` has target_deg, command_deg (NaN where none was found) and status; `inverse_rmse` is of
    model_deg against target_deg over the targets that have a command.
    """
    target = table["target_deg"].to_numpy(float)
    command = table["command_deg"].to_numpy(float)
    n = len(table)
    counts = table["status"].value_counts().sort_index()
    rows: list[Row] = [
        (axis, method, None, "commanded_travel", travel_deg(command), "deg", n),
        (axis, method, None, "shortest_travel", shortest_travel_deg(target, command), "deg", n),
        *((axis, method, None, f"targets_{k}", int(v), "targets", n) for k, v in counts.items()),
    ]
    if {"model_deg", "iterations"} <= set(table):
        error = table["model_deg"].to_numpy(float) - target
        found = int(np.isfinite(error).sum())
        iterations = float(table["iterations"].mean())
        rows.append((axis, method, None, "inverse_rmse", rms(error), "deg", found))
        rows.append((axis, method, None, "inverse_iterations", iterations, "a target", n))
    return rows


def _landing_error(landing: pd.DataFrame, judge: str) -> np.ndarray:
    return landing[JUDGES[judge]].to_numpy(float) - landing["target_deg"].to_numpy(float)


def paper_table(metrics: pd.DataFrame) -> pd.DataFrame:
    """The paper's table: nominal against compensated, on the test cycles and in closed loop.

    One row for each axis and way of judging: `axis`, `judged by`, RMSE [deg] and tip error [um] of
    either method, improvement [%]. Rows that were not run are left out.
    """
    judges = (
        ("model on test cycles", "model_rmse", "model_tip_rmse", "model_improvement"),
        ("robot, seen by camera", "landing_rmse_camera", "landing_tip_rmse_camera",
         "landing_improvement_camera"),
        ("robot, true pose", "landing_rmse_true", "landing_tip_rmse_true",
         "landing_improvement_true"),
    )  # fmt: skip
    value = _lookup(metrics)
    rows = [
        {
            "axis": axis,
            "judged by": judge,
            "nominal RMSE [deg]": value(axis, "nominal", rmse),
            "compensated RMSE [deg]": value(axis, "compensated", rmse),
            "improvement [%]": value(axis, "compensated", improvement),
            "nominal tip [um]": value(axis, "nominal", tip),
            "compensated tip [um]": value(axis, "compensated", tip),
        }
        for axis in dict.fromkeys(metrics["axis"])
        for judge, rmse, tip, improvement in judges
        if np.isfinite(value(axis, "compensated", rmse))
    ]
    return pd.DataFrame(rows)


def closed_loop_table(metrics: pd.DataFrame) -> pd.DataFrame:
    """How each way of inverting did on the robot: RMSE, travel against the shortest, statuses."""
    landed = metrics[metrics["metric"] == "commanded_travel"]
    statuses = [m for m in dict.fromkeys(metrics["metric"]) if m.startswith("targets_")]
    value = _lookup(metrics)
    rows = []
    for axis, method in zip(landed["axis"], landed["method"], strict=True):
        row: dict[str, object] = {
            "axis": axis,
            "method": method,
            "camera RMSE [deg]": value(axis, method, "landing_rmse_camera"),
            "true RMSE [deg]": value(axis, method, "landing_rmse_true"),
            "travel [deg]": value(axis, method, "commanded_travel"),
            "shortest [deg]": value(axis, method, "shortest_travel"),
        }
        for status in statuses:
            count = value(axis, method, status)
            row[status.removeprefix("targets_")] = 0 if np.isnan(count) else int(count)
        rows.append(row)
    return pd.DataFrame(rows)


def _lookup(metrics: pd.DataFrame) -> Callable[[str, str, str], float]:
    pooled = metrics[metrics["cycle"].isna()]
    keys = zip(pooled["axis"], pooled["method"], pooled["metric"], strict=True)
    values = dict(zip(keys, pooled["value"], strict=True))
    return lambda axis, method, metric: float(values.get((axis, method, metric), float("nan")))


def _at(where: np.ndarray, values: np.ndarray | None) -> np.ndarray:
    out = np.full(len(where), np.nan)
    if values is not None:
        out[where] = values
    return out

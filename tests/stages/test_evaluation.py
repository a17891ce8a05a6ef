import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose
from play_loop import play_recording

from pipeline.config import EvaluationConfig, TrainingConfig
from pipeline.errors import LoopgapError
from pipeline.models.loop_model import LoopModel
from pipeline.recording import Channel, Recording, RecordingError
from pipeline.stages.evaluation import (
    evaluate,
    improvement_percent,
    land,
    predict_cycles,
    rms,
    shortest_travel_deg,
    tip_error_um,
    travel_deg,
)

TARGETS = np.array([0.0, 10.0, 20.0, 10.0, 0.0, -10.0, 0.0])


def predictions(nominal_error: float, compensated_error: float, n: int = 50) -> pd.DataFrame:
    angle = np.linspace(-20.0, 20.0, n)
    sign = np.where(np.arange(n) % 2 == 0, 1.0, -1.0)
    return pd.DataFrame(
        {
            "cycle": np.arange(n) // (n // 2),
            "measured_deg": angle,
            "nominal_deg": angle - nominal_error * sign,
            "nominal_std_deg": 1.0,
            "compensated_deg": angle - compensated_error * sign,
            "compensated_std_deg": 1.0,
        }
    )


def landing(error_deg: float, command_deg: np.ndarray, status: str = "converged") -> pd.DataFrame:
    return pd.DataFrame(
        {
            "target_deg": TARGETS,
            "command_deg": command_deg,
            "status": status,
            "measured_deg": TARGETS + error_deg,
            "true_deg": TARGETS + 0.5 * error_deg,
        }
    )


def value(metrics: pd.DataFrame, axis: str, method: str, metric: str) -> float:
    found = metrics.query("axis == @axis and method == @method and metric == @metric")
    found = found[found["cycle"].isna()]
    assert len(found) == 1
    return float(found["value"].iloc[0])


def recording_of(command: list[float], angle: list[float]) -> Recording:
    samples = pd.DataFrame(
        {"time_s": range(len(command)), "cycle": 0, "step": range(len(command)),
         "yaw_command_deg": command, "yaw_angle_deg": angle}
    )  # fmt: skip
    channels = (
        Channel("yaw_command_deg", "command", "deg"),
        Channel("yaw_angle_deg", "measurement", "deg"),
    )
    return Recording(samples, channels)


def test_tip_error_is_the_chord_of_the_angle() -> None:
    assert_allclose(tip_error_um(np.array([60.0, -60.0, 180.0]), 3.0), [3000.0, 3000.0, 6000.0])
    small = tip_error_um(np.array([1.0]), 3.0)
    assert_allclose(small, 3000.0 * np.pi / 180.0, rtol=2e-5)


def test_rms_leaves_out_what_was_not_measured() -> None:
    assert_allclose(rms(np.array([3.0, np.nan, -4.0])), np.sqrt(12.5))
    assert np.isnan(rms(np.array([np.nan])))


def test_improvement_of_nothing_is_undefined() -> None:
    assert_allclose(improvement_percent(2.0, 0.5), 75.0)
    assert np.isnan(improvement_percent(0.0, 0.5))


def test_travel_against_the_shortest() -> None:
    straight = np.array([0.0, 12.0, 24.0, 8.0, -4.0, -16.0, 4.0])
    assert_allclose(travel_deg(straight), 24.0 + 40.0 + 20.0)
    assert_allclose(shortest_travel_deg(TARGETS, straight), travel_deg(straight))
    detour = straight.copy()
    detour[1], detour[4] = 30.0, 6.0
    assert_allclose(shortest_travel_deg(TARGETS, detour), 84.0)
    assert travel_deg(detour) > 84.0


def test_travel_skips_targets_without_a_command() -> None:
    command = np.array([0.0, np.nan, 24.0, 8.0, np.nan, -16.0, 4.0])
    assert_allclose(travel_deg(command), 84.0)
    assert_allclose(shortest_travel_deg(TARGETS, command), 84.0)
    assert shortest_travel_deg(TARGETS, np.full(7, np.nan)) == 0.0


def test_known_errors_come_out_as_metrics_and_table() -> None:
    command = 1.5 * TARGETS
    landings = {"pitch": {"compensated": landing(0.4, command), "nominal": landing(-1.6, command)}}
    result = evaluate(EvaluationConfig(), {"pitch": predictions(2.0, 0.5)}, landings)
    metrics = result.metrics
    assert_allclose(value(metrics, "pitch", "nominal", "model_rmse"), 2.0)
    assert_allclose(value(metrics, "pitch", "compensated", "model_rmse"), 0.5)
    assert_allclose(value(metrics, "pitch", "compensated", "model_improvement"), 75.0)
    assert_allclose(value(metrics, "pitch", "nominal", "model_coverage_95"), 0.0)
    assert_allclose(value(metrics, "pitch", "compensated", "model_coverage_95"), 100.0)
    tip_um = 6000.0 * np.sin(np.radians(2.0) / 2)
    assert_allclose(value(metrics, "pitch", "nominal", "model_tip_rmse"), tip_um)
    assert_allclose(value(metrics, "pitch", "compensated", "landing_rmse_camera"), 0.4)
    assert_allclose(value(metrics, "pitch", "compensated", "landing_rmse_true"), 0.2)
    assert_allclose(value(metrics, "pitch", "compensated", "landing_improvement_true"), 75.0)
    assert_allclose(value(metrics, "pitch", "nominal", "targets_converged"), 7.0)

    assert list(result.table["judged by"]) == [
        "model on test cycles", "robot, seen by camera", "robot, true pose",
    ]  # fmt: skip
    assert_allclose(result.table["nominal RMSE [deg]"], [2.0, 1.6, 0.8])
    assert_allclose(result.table["compensated RMSE [deg]"], [0.5, 0.4, 0.2])
    assert_allclose(result.table["improvement [%]"], 75.0)
    assert list(result.closed_loop["method"]) == ["compensated", "nominal"]
    assert_allclose(result.closed_loop["travel [deg]"], result.closed_loop["shortest [deg]"])


def test_every_test_cycle_is_scored_beside_the_whole() -> None:
    table = predictions(2.0, 0.5)
    table.loc[table["cycle"] == 1, "nominal_deg"] = table["measured_deg"] + 1.0
    metrics = evaluate(EvaluationConfig(), {"yaw": table}, {}).metrics
    nominal = metrics.query("metric == 'model_rmse' and method == 'nominal'")
    assert nominal["cycle"].tolist() == [pd.NA, 0, 1]
    assert nominal["n"].tolist() == [50, 25, 25]
    assert_allclose(nominal["value"], [np.sqrt(2.5), 2.0, 1.0])
    gained = metrics.query("metric == 'model_improvement'").set_index("cycle")["value"]
    assert_allclose(gained[[0, 1]], [75.0, 50.0])


def test_a_search_is_scored_without_a_robot() -> None:
    found = landing(0.0, 1.5 * TARGETS).drop(columns=["measured_deg", "true_deg"])
    found = found.assign(model_deg=TARGETS + 0.1, iterations=[1, 2, 3, 4, 5, 6, 7])
    metrics = evaluate(EvaluationConfig(), {}, {}, {"yaw": {"compensated": found}}).metrics
    assert_allclose(value(metrics, "yaw", "compensated", "inverse_rmse"), 0.1)
    assert_allclose(value(metrics, "yaw", "compensated", "inverse_iterations"), 4.0)
    assert_allclose(value(metrics, "yaw", "compensated", "commanded_travel"), 90.0)
    assert_allclose(value(metrics, "yaw", "compensated", "targets_converged"), 7.0)


def test_statuses_are_counted_for_each_method() -> None:
    nominal = landing(1.0, TARGETS)
    nominal["status"] = ["clipped", *["converged"] * 6]
    landings = {"yaw": {"nominal": nominal, "as_printed": landing(1.0, TARGETS, "unreachable")}}
    table = evaluate(EvaluationConfig(), {}, landings).closed_loop.set_index("method")
    assert table.loc["nominal", ["clipped", "converged", "unreachable"]].tolist() == [1, 6, 0]
    assert table.loc["as_printed", ["clipped", "converged", "unreachable"]].tolist() == [0, 0, 7]


def test_without_truth_and_trial_only_the_model_is_judged() -> None:
    real = landing(0.5, TARGETS).assign(true_deg=np.nan)
    both = evaluate(EvaluationConfig(), {"yaw": predictions(2.0, 1.0)}, {"yaw": {"nominal": real}})
    assert not both.metrics["metric"].str.endswith("_true").any()
    model_only = evaluate(EvaluationConfig(), {"yaw": predictions(2.0, 1.0)}, {})
    assert list(model_only.table["judged by"]) == ["model on test cycles"]
    assert model_only.closed_loop.empty


def test_missing_measurements_are_counted_not_filled() -> None:
    table = predictions(2.0, 0.5)
    table.loc[:9, "measured_deg"] = np.nan
    metrics = evaluate(EvaluationConfig(), {"yaw": table}, {}).metrics
    rows = metrics[(metrics["metric"] == "model_rmse") & metrics["cycle"].isna()]
    assert rows["n"].tolist() == [40, 40]
    assert_allclose(rows["value"], [2.0, 0.5])
    assert value(metrics, "yaw", "nominal", "model_not_measured") == 10.0


def test_land_puts_each_landing_beside_its_target() -> None:
    commands = pd.DataFrame(
        {"target_deg": [1.0, 99.0, 2.0], "command_deg": [1.5, np.nan, 3.0],
         "status": ["converged", "unreachable", "converged"]}
    )  # fmt: skip
    truth = pd.DataFrame({"yaw_true_deg": [1.1, 2.2]})
    landed = land(commands, recording_of([1.5, 3.0], [1.2, np.nan]), truth, "yaw")
    assert_allclose(landed["measured_deg"], [1.2, np.nan, np.nan])
    assert_allclose(landed["true_deg"], [1.1, np.nan, 2.2])
    assert (
        land(commands, recording_of([1.5, 3.0], [1.2, 2.0]), None, "yaw")["true_deg"].isna().all()
    )


@pytest.mark.parametrize("sent", [[1.5], [1.5, 2.9]])
def test_land_refuses_another_recording(sent: list[float]) -> None:
    commands = pd.DataFrame(
        {"target_deg": [1.0, 2.0], "command_deg": [1.5, 3.0], "status": "converged"}
    )
    with pytest.raises(LoopgapError, match="closed loop of yaw: expected the 2 commands"):
        land(commands, recording_of(sent, [0.0] * len(sent)), None, "yaw")


def test_predictions_take_their_branch_from_the_whole_recording() -> None:
    recording = play_recording("pitch", 1.57, 0.1, 0, cycles=4, steps=80)
    k = {"nominal": 3, "cw": 3, "ccw": 3}
    model = LoopModel.fit(recording, "pitch", [0, 1, 2], k, TrainingConfig(n_init=1), seed=0)
    table = predict_cycles(model, recording, [3])
    assert len(table) == 80
    assert table["direction"].iloc[0] == 1  # ascends from the last descent's end
    metrics = evaluate(EvaluationConfig(), {"pitch": table}, {}).metrics
    assert value(metrics, "pitch", "nominal", "model_rmse") > 0.8
    assert value(metrics, "pitch", "compensated", "model_rmse") < 0.3
    with pytest.raises(RecordingError, match=r"none in \[7\]"):
        predict_cycles(model, recording, [7])

import numpy as np
import pytest
from play_loop import play_recording

from pipeline.config import SelectionConfig, TrainingConfig
from pipeline.errors import LoopgapError, UsageError
from pipeline.models.loop_model import branch_samples
from pipeline.models.mixture import MixtureError
from pipeline.recording import Recording
from pipeline.stages.selection import COLUMNS, heldout_rmse_deg, select, selection_metrics

TRAIN = [0, 1, 2, 3, 4, 5]
TRAINING = TrainingConfig()


@pytest.fixture(scope="module")
def recordings() -> dict[str, Recording]:
    return {
        "yaw": play_recording("yaw", 1.2, 0.4, seed=0, steps=80),
        "pitch": play_recording("pitch", 2.2, 0.4, seed=1, steps=80),
    }


def config(**changes: object) -> SelectionConfig:
    return SelectionConfig(**({"k_max": 6, "n_init": 1} | changes))  # type: ignore[arg-type]


def test_table_has_a_row_for_every_axis_model_and_k(recordings: dict[str, Recording]) -> None:
    selection = select(config(), TRAINING, recordings, TRAIN, seed=0)
    assert tuple(selection.table.columns) == COLUMNS
    assert len(selection.table) == 2 * 3 * 6
    assert np.isfinite(selection.table[["bic", "aic", "heldout_rmse_deg"]]).all(axis=None)
    assert (selection.table["bic"] > selection.table["aic"]).all()


def test_scores_that_nobody_asks_for_stay_empty(recordings: dict[str, Recording]) -> None:
    wanted = config(scores=["aic"], k_max=3)
    selection = select(wanted, TRAINING, {"yaw": recordings["yaw"]}, TRAIN, seed=0)
    assert selection.table["heldout_rmse_deg"].isna().all()
    metrics = selection_metrics(selection)
    assert set(metrics["metric"]) == {"chosen_k", "bic", "aic"}
    chosen = metrics.query("metric == 'chosen_k'").set_index("method")["value"]
    assert chosen.to_dict() == selection.chosen["yaw"]
    with pytest.raises(UsageError, match="some of bic, aic, heldout; found 'cv'"):
        select(config(scores=["cv"]), TRAINING, recordings, TRAIN, seed=0)


@pytest.mark.parametrize("criterion", ["bic", "aic"])
def test_criteria_choose_their_smallest_score(
    recordings: dict[str, Recording], criterion: str
) -> None:
    selection = select(config(criterion=criterion), TRAINING, recordings, TRAIN, seed=0)
    for (axis, model), rows in selection.table.groupby(["axis", "model"]):
        best = rows["k"].to_numpy()[np.argmin(rows[criterion].to_numpy())]
        assert selection.chosen[str(axis)][str(model)] == best


def test_heldout_takes_the_smallest_k_that_is_as_good_as_the_best(
    recordings: dict[str, Recording],
) -> None:
    selection = select(config(criterion="heldout"), TRAINING, recordings, TRAIN, seed=0)
    for (axis, model), rows in selection.table.groupby(["axis", "model"]):
        k, error = rows["k"].to_numpy(), rows["heldout_rmse_deg"].to_numpy()
        chosen = selection.chosen[str(axis)][str(model)]
        assert error[k == chosen][0] <= 1.01 * error.min()
        assert (error[k < chosen] > 1.01 * error.min()).all()


def test_heldout_error_of_a_branch_is_its_noise(recordings: dict[str, Recording]) -> None:
    samples = branch_samples(recordings["pitch"], "pitch", TRAIN)
    assert heldout_rmse_deg(samples["cw"], 4, TRAINING, seed=0) == pytest.approx(0.45, abs=0.08)
    assert heldout_rmse_deg(samples["nominal"], 4, TRAINING, seed=0) > 1.2


def test_two_clearly_separate_pieces_take_two_gaussians() -> None:
    """A bend by half in the middle: one line can't follow it."""
    recording = play_recording("yaw", 0.0, 0.05, seed=0, cycles=4, steps=80)
    command = recording.values("yaw_command_deg")
    noise = 0.05 * np.random.default_rng(0).standard_normal(len(command))
    bent = np.where(command < 0.0, 0.2, 1.2) * command + noise
    recording.samples["yaw_angle_deg"] = bent
    selection = select(config(), TRAINING, {"yaw": recording}, [0, 1, 2, 3], seed=0)
    assert min(selection.chosen["yaw"].values()) >= 2
    one = selection.table[selection.table["k"] == 1]["heldout_rmse_deg"]
    two = selection.table[selection.table["k"] == 2]["heldout_rmse_deg"]
    assert (two.to_numpy() < 0.3 * one.to_numpy()).all()


def test_fixed_k_is_taken_for_every_model_and_scored(recordings: dict[str, Recording]) -> None:
    selection = select(config(k=4), TRAINING, recordings, TRAIN, seed=0)
    assert selection.chosen["pitch"] == {"nominal": 4, "cw": 4, "ccw": 4}
    assert selection.table["k"].tolist() == [4] * 6
    assert np.isfinite(selection.table["bic"]).all()


def test_test_cycles_have_no_say() -> None:
    clean = play_recording("yaw", 1.2, 0.4, seed=0, steps=40)
    spoilt = play_recording("yaw", 1.2, 0.4, seed=0, steps=40)
    spoilt.samples.loc[spoilt.samples["cycle"] > 5, "yaw_angle_deg"] = 1e6
    tables = [
        select(config(k_max=3), TRAINING, {"yaw": r}, TRAIN, seed=0).table for r in (clean, spoilt)
    ]
    assert tables[0].equals(tables[1])


def test_k_beyond_the_samples_is_left_empty_in_the_table() -> None:
    recording = play_recording("yaw", 1.2, 0.4, seed=0, cycles=2, steps=16)
    table = select(config(), TRAINING, {"yaw": recording}, [0, 1], seed=0).table
    cw = table[table["model"] == "cw"].set_index("k")
    assert np.isfinite(cw.loc[1:5, "bic"]).all()
    assert cw.loc[6, ["bic", "aic", "heldout_rmse_deg"]].isna().all()


def test_fixed_k_larger_than_the_samples_allow_is_refused() -> None:
    recording = play_recording("yaw", 1.2, 0.4, seed=0, cycles=2, steps=16)
    with pytest.raises(MixtureError, match="yaw, nominal model: .*at least 60 .*K = 20; found 32"):
        select(config(k=20), TRAINING, {"yaw": recording}, [0, 1], seed=0)


def test_one_cycle_can_not_be_chosen_by_heldout_error() -> None:
    recording = play_recording("yaw", 1.2, 0.4, seed=0, cycles=2, steps=40)
    with pytest.raises(LoopgapError, match="Train on at least two cycles"):
        select(config(criterion="heldout"), TRAINING, {"yaw": recording}, [0], seed=0)
    chosen = select(config(), TRAINING, {"yaw": recording}, [0], seed=0)
    assert chosen.table["heldout_rmse_deg"].isna().all()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"criterion": "r2"}, "one of bic, aic, heldout; found 'r2'"),
        ({"k_max": 0}, "selection.k_max: expected at least 1; found 0"),
    ],
)
def test_impossible_settings_are_refused(
    recordings: dict[str, Recording], change: dict[str, object], message: str
) -> None:
    with pytest.raises(UsageError, match=message):
        select(config(**change), TRAINING, recordings, TRAIN, seed=0)

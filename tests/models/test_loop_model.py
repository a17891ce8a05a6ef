import json

import numpy as np
import pytest
from play_loop import play_recording

from pipeline.config import TrainingConfig
from pipeline.errors import LoopgapError
from pipeline.models.loop_model import MODELS, LoopModel, branch_samples
from pipeline.models.mixture import MixtureError
from pipeline.recording import RecordingError, branch_of

CONFIG = TrainingConfig(n_init=2)
K4 = dict.fromkeys(MODELS, 4)


@pytest.fixture(scope="module")
def model() -> LoopModel:
    recording = play_recording("pitch", 2.5, 0.4, seed=0)
    return LoopModel.fit(recording, "pitch", range(6), K4, CONFIG, seed=0)


def test_split_model_is_down_to_the_noise_where_the_nominal_is_not(model: LoopModel) -> None:
    recording = play_recording("pitch", 2.5, 0.4, seed=1)
    command, angle = (recording.values(f"pitch_{n}_deg") for n in ("command", "angle"))
    split = angle - model.predict(command, branch_of(command))[0]
    nominal = angle - model.predict(command, 0)[0]
    assert np.sqrt(np.mean(split**2)) < 0.5
    assert np.sqrt(np.mean(nominal**2)) > 1.6


def test_each_direction_asks_its_own_mixture(model: LoopModel) -> None:
    command = np.array([10.0, 10.0, 10.0])
    mean, deviation = model.predict(command, np.array([1, -1, 0]))
    for i, mixture in enumerate((model.cw, model.ccw, model.nominal)):
        one = mixture.predict(command[:1])
        assert (mean[i], deviation[i]) == (one[0][0], one[1][0])
    # Play of +-2.5 deg: the ascending branch lags below the descending one by 2 x 2.5 x 0.7 deg.
    assert mean[1] - mean[0] == pytest.approx(3.5, abs=0.3)
    assert deviation[2] > deviation[0]


def test_branches_share_the_samples_of_the_wanted_cycles() -> None:
    recording = play_recording("yaw", 1.0, 0.1, seed=0, cycles=4, steps=40)
    samples = branch_samples(recording, "yaw", [1, 3])
    assert set(samples["nominal"].cycle) == {1, 3}
    assert len(samples["nominal"].cycle) == 80
    assert len(samples["cw"].cycle) == len(samples["ccw"].cycle) == 40
    # The first sample of a cycle is reached from below: the cycle before knows that.
    assert 0.0 in samples["cw"].command_deg
    assert samples["cw"].only([3]).cycle.tolist() == [3] * 20


def test_json_keeps_the_model(model: LoopModel) -> None:
    again = LoopModel.from_json(json.loads(json.dumps(model.as_json())))
    command = np.linspace(-70.0, 70.0, 30)
    for direction in (1, 0, -1):
        np.testing.assert_array_equal(
            model.predict(command, direction), again.predict(command, direction)
        )
    assert (again.command, again.measurement) == ("pitch_command_deg", "pitch_angle_deg")


def test_another_schema_is_refused(model: LoopModel) -> None:
    with pytest.raises(LoopgapError, match=r"schema 'loopgap.loop_model/1'; found 'other/1'"):
        LoopModel.from_json(model.as_json() | {"schema": "other/1"})


def test_model_without_a_branch_is_refused(model: LoopModel) -> None:
    entry = model.as_json()
    del entry["ccw"]
    with pytest.raises(LoopgapError, match="expected a key 'ccw'"):
        LoopModel.from_json(entry)


def test_axis_that_was_not_recorded_is_refused() -> None:
    recording = play_recording("yaw", 1.0, 0.1, seed=0, cycles=3, steps=40)
    with pytest.raises(RecordingError, match="a channel 'pitch_command_deg'"):
        branch_samples(recording, "pitch", [0])


def test_cycles_that_were_not_recorded_are_refused() -> None:
    recording = play_recording("yaw", 1.0, 0.1, seed=0, cycles=3, steps=40)
    with pytest.raises(RecordingError, match=r"none in \[7\]"):
        branch_samples(recording, "yaw", [0, 7])


def test_too_large_k_names_axis_and_model() -> None:
    recording = play_recording("yaw", 1.0, 0.1, seed=0, cycles=1, steps=40)
    k = {"nominal": 2, "cw": 10, "ccw": 2}
    with pytest.raises(MixtureError, match="yaw, cw model: .*K = 10; found 20"):
        LoopModel.fit(recording, "yaw", [0], k, CONFIG, seed=0)

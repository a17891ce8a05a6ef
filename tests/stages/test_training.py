import numpy as np
import pytest
from play_loop import play_recording

from pipeline.config import TrainingConfig
from pipeline.models.loop_model import MODELS
from pipeline.recording import branch_of
from pipeline.stages.training import train

CONFIG = TrainingConfig(n_init=2)


def test_models_predict_cycles_that_they_have_not_seen() -> None:
    """Noise s and play r: s is left of the split model, s and r of the nominal one."""
    widths = {"yaw": 1.2, "pitch": 2.2}
    recordings = {
        axis: play_recording(axis, width, 0.4, seed=i)
        for i, (axis, width) in enumerate(widths.items())
    }
    chosen = {axis: dict.fromkeys(MODELS, 9) for axis in widths}
    models = train(CONFIG, recordings, range(6), chosen, seed=0)
    assert set(models) == set(widths)
    for axis, width in widths.items():
        test = recordings[axis].samples["cycle"].to_numpy() >= 6
        command = recordings[axis].values(f"{axis}_command_deg")
        angle = recordings[axis].values(f"{axis}_angle_deg")[test]
        split = angle - models[axis].predict(command[test], branch_of(command)[test])[0]
        nominal = angle - models[axis].predict(command[test], 0)[0]
        assert np.sqrt(np.mean(split**2)) == pytest.approx(0.4, abs=0.04)
        expected = np.hypot(0.4, 0.75 * width)
        assert np.sqrt(np.mean(nominal**2)) == pytest.approx(expected, rel=0.08)


def test_each_model_takes_its_own_k_and_only_the_training_cycles() -> None:
    recording = play_recording("yaw", 1.2, 0.4, seed=0, cycles=4, steps=60)
    recording.samples.loc[recording.samples["cycle"] == 2, "yaw_angle_deg"] = np.nan
    chosen = {"yaw": {"nominal": 5, "cw": 2, "ccw": 3}}
    model = train(CONFIG, {"yaw": recording}, [0, 2, 3], chosen, seed=0)["yaw"]
    assert (model.nominal.k, model.cw.k, model.ccw.k) == (5, 2, 3)
    assert (model.nominal.samples, model.nominal.left_out) == (120, 60)

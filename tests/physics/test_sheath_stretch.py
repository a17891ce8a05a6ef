"""The stretch of a wire in its sheath."""

import numpy as np
import pandas as pd
import pytest

from pipeline.config import DiagnosisConfig
from pipeline.physics.motion import Motion
from pipeline.physics.sheath_stretch import SheathStretch
from pipeline.recording import Channel, Recording, with_context
from pipeline.stages.diagnosis import diagnose


def stretched(pull, *values, state=None):
    motion = Motion(pull, np.arange(len(pull)) / 10.0, np.zeros(len(pull), dtype=np.int64))
    return SheathStretch().respond(pull, motion, np.array(values), state)


def test_a_pulled_wire_stretches_by_the_mean_of_an_exponential() -> None:
    pull = np.linspace(1.0, 100.0, 400)
    mean = stretched(pull, 0.8, 1.0, 0.0)[0]
    assert mean[-1] == pytest.approx(100.0 * (1.0 - np.exp(-0.8)) / 0.8, rel=1e-3)


def test_the_turn_begins_at_the_near_end_and_blocks_answer_as_one() -> None:
    pull = np.concatenate([np.linspace(20.0, 100.0, 300), np.linspace(100.0, 20.0, 300)])
    whole, _ = stretched(pull, 0.8, 1.0, 5.0)
    slopes = np.abs(np.diff(whole)[300:] / np.diff(pull)[300:])
    assert slopes[0] < 0.1 * slopes[200]
    first, state = stretched(pull[:250], 0.8, 1.0, 5.0)
    second, _ = stretched(pull[250:], 0.8, 1.0, 5.0, state=state)
    assert np.allclose(np.concatenate([first, second]), whole)


def test_friction_is_named_alone_for_the_elongation_of_a_segmented_wire():
    pull = 40.0 + 30.0 * np.sin(2 * np.pi * np.arange(900) / 150.0)
    tension = np.full(40, pull[0])
    stretch = np.empty(900)
    for i, force in enumerate(pull):
        for j in range(40):
            low, high = (before := force if j == 0 else tension[j - 1]) * 0.985, before / 0.985
            tension[j] = min(max(tension[j], low), high)
        stretch[i] = tension.mean() / 12.0
    stretch += 0.01 * np.random.default_rng(3).standard_normal(900)
    names = ("tension_n", "elongation_mm", "line_mm")
    channels = (
        Channel(names[0], "command", "N"),
        Channel(names[1], "measurement", "mm"),
        Channel(names[2], "simulation", "mm", of=names[1]),
    )
    columns = dict(zip(names, (pull, stretch, pull / 12.0), strict=True))
    table = with_context(pd.DataFrame({"time_s": np.arange(900) / 50.0, **columns}), channels)
    (found,) = diagnose(DiagnosisConfig(), Recording(table, channels, "simulated")).diagnoses
    assert [p.name for p in found.physics] == ["friction"]
    assert found.verdict == "explained"
    assert found.physics[0].parameters[0].value == pytest.approx(-40 * np.log(0.985), rel=0.05)
    assert found.after.heldout_rmse < 1.1 * 0.01

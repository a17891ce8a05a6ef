"""What a diagnosis notes beside its names."""

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from pipeline.config import DiagnosisConfig
from pipeline.discrepancy.judgement.calibration_note import calibration_note
from pipeline.discrepancy.judgement.notes import doubled_note, nearer_note, other_simulations_note
from pipeline.discrepancy.problem.posing import pose_problem
from pipeline.recording import Channel, Recording, with_context

CHANNELS = (
    Channel("motor_deg", "command", "deg"),
    Channel("tip_deg", "measurement", "deg"),
    Channel("tip_sim_deg", "simulation", "deg", of="tip_deg"),
)


@pytest.mark.parametrize(("lag_s", "said"), [(0.0, True), (0.5, False)])
def test_a_simulation_that_lags_where_the_mechanism_does_not_is_said(lag_s, said):
    time_s = 0.01 * np.arange(3000)
    command, simulated, moved = (40.0 * np.sin(time_s - late) for late in (0.0, 0.5, lag_s))
    measured = 0.9 * moved + 0.5 * np.random.default_rng(1).standard_normal(3000)
    columns = [time_s, command, measured, simulated]
    names = ["time_s", *(channel.name for channel in CHANNELS)]
    samples = pd.DataFrame(np.column_stack(columns), columns=names)
    recording = Recording(with_context(samples, CHANNELS), CHANNELS, "real")
    problem = pose_problem(DiagnosisConfig(), recording, "tip_deg", simulated)
    evidence = SimpleNamespace(recording=recording, used=np.isfinite(measured))
    assert not problem.static
    assert [note.startswith("A line in motor_deg") for note in nearer_note(problem, evidence)] == (
        [True] if said else []
    )


def test_rows_that_were_written_twice_are_said():
    time_s = np.repeat(0.1 * np.arange(5.0), [1, 2, 1, 3, 1])
    samples = pd.DataFrame({"time_s": time_s, "motor_deg": time_s, "tip_deg": np.sin(time_s)})
    once = samples.drop_duplicates()
    (note,) = doubled_note(Recording(with_context(samples, CHANNELS[:2]), CHANNELS[:2], "real"))
    assert note.startswith("3 of 8 rows repeat the one before")
    assert doubled_note(Recording(with_context(once, CHANNELS[:2]), CHANNELS[:2], "real")) == []


def test_simulations_that_nobody_looked_at_are_said():
    other = Channel("tip_elsewhere_deg", "simulation", "deg", of="tip_deg")
    recording = Recording(pd.DataFrame(), (*CHANNELS, other), "real")
    (note,) = other_simulations_note(recording, "tip_deg")
    assert note.startswith(
        "tip_elsewhere_deg simulates tip_deg, too, and was left out: tip_sim_deg"
    )
    assert other_simulations_note(Recording(pd.DataFrame(), CHANNELS, "real"), "tip_deg") == []


@pytest.mark.parametrize(
    ("gain", "looks_like"),
    [
        (0.0178, ["a degree in radians"]),
        (-55.0, ["negative", "a radian in degrees"]),
        (960.0, ["a thousand:"]),
        (6.2, ["a turn in radians"]),
        (-1.01, ["negative"]),
        (1.4, []),
    ],
)
def test_a_mix_up_of_units_or_sign_is_told_by_the_gain(gain: float, looks_like: list[str]) -> None:
    note = calibration_note(gain, 0.3, "deg")
    assert all(words in note for words in looks_like)
    assert note.count(" is about ") == sum(words != "negative" for words in looks_like)
    assert ("negative" in note) == ("negative" in looks_like)
    assert note.startswith("The calibration (gain ")

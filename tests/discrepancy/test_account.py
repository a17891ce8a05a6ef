from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from pipeline.discrepancy.account import located_in, with_account
from pipeline.discrepancy.model.result import Calibration, Diagnosis, Errors, Evidence, Unexplained
from pipeline.discrepancy.noise.noise import NoiseModel
from pipeline.physics.motion import Motion
from pipeline.recording import Channel, Recording


@pytest.fixture
def evidence() -> Evidence:
    """A contact beyond 30 deg, six cycles, every third held out."""
    phase = np.arange(1200) / 200
    drive = 60.0 * (4.0 * np.abs((phase + 0.75) % 1.0 - 0.5) - 1.0)
    cycle, time_s = np.arange(1200) // 200, 3.0 * np.arange(1200)
    simulated = 0.7 * drive
    noise = 0.1 * np.random.default_rng(0).standard_normal(1200)
    measured = simulated - 0.2 * np.maximum(0.0, drive - 30.0) + noise
    samples = pd.DataFrame({"time_s": time_s, "cycle": cycle, "step": np.arange(1200) % 200,
                            "pitch_command_deg": drive, "pitch_angle_deg": measured})  # fmt: skip
    channels = (Channel("pitch_command_deg", "command", "deg"),
                Channel("pitch_angle_deg", "measurement", "deg"))  # fmt: skip
    heldout = cycle % 3 == 2
    return Evidence(
        recording=Recording(samples, channels), measurement="pitch_angle_deg",
        drive="pitch_command_deg", static=True, motion=Motion(drive, time_s, cycle),
        measured=measured, train=~heldout, heldout=heldout, used=np.ones(1200, dtype=bool),
        mistaken=np.zeros(1200, dtype=bool),
        before=simulated, after=simulated, deviation=np.ones(1200), noise=NoiseModel(0.1),
        hypotheses=(),
    )  # fmt: skip


def where(evidence: Evidence) -> dict[str, str]:
    found = located_in(evidence, evidence.residual_before)
    return {entry.coordinate: entry.where for entry in found if entry.where}


def test_held_out_rows_have_no_say(evidence: Evidence) -> None:
    spoilt = np.where(evidence.heldout, 50.0 * np.sign(evidence.motion.drive), evidence.measured)
    assert where(replace(evidence, measured=spoilt)) == where(evidence)
    assert where(evidence)["command"].endswith("on the positive side")


def test_outliers_that_no_fit_used_are_located_too(evidence: Evidence) -> None:
    wrong = evidence.train & (np.arange(1200) % 50 == 7)
    measured = np.where(wrong, evidence.measured + 20.0, evidence.measured)
    found = where(replace(evidence, measured=measured, used=~wrong))
    assert found["single_frames"].startswith(f"in {wrong.sum()} single frames")
    assert "command" in found


def test_the_command_is_looked_along_where_a_trace_drives(evidence: Evidence) -> None:
    trace = replace(evidence.motion, drive=0.01 * evidence.motion.drive**3)
    assert where(replace(evidence, static=False, motion=trace)) == where(evidence)


def test_the_account_stands_in_the_diagnosis(evidence: Evidence) -> None:
    bare = Diagnosis(
        "pitch_angle_deg", "deg", "unknown_physics", 0.1, Errors(2.0, 2.0), Errors(2.0, 2.0), (),
        (), Calibration(1.0, 0.0), Unexplained(0.9, 0.0, "the command"), (), None,
    )  # fmt: skip
    diagnosis, proof, proposal = with_account(bare, evidence, "next_commands.csv")
    assert diagnosis.location[0].coordinate == proof.located[0].coordinate == "command"
    assert diagnosis.next_experiment is not None
    assert diagnosis.next_experiment.commands == "next_commands.csv"
    assert proposal is not None
    assert proposal.commands is not None


def test_errors_of_rows_that_are_all_outliers_are_those_of_all(evidence: Evidence) -> None:
    found = replace(evidence, used=evidence.train).errors(evidence.before)
    assert found == evidence.errors(evidence.before)

"""A simulation that was fitted to the recording: its gain and bend are held against no term."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from pipeline.config import DiagnosisConfig, ToleranceConfig
from pipeline.discrepancy.problem.fitted import goes_by, tolerance_of_fit
from pipeline.physics.motion import Kinetics, Motion
from pipeline.physics.play_operator import play
from pipeline.physics.pre_sliding import dragging
from pipeline.recording import Channel, Recording, with_context
from pipeline.stages.diagnosis import diagnose

N = 1200
PHASE = 2 * np.pi * np.arange(N) / 200
DRIVE = 180.0 * np.sin(PHASE) * (0.6 + 0.4 * np.cos(PHASE / 3.0))
PLAYED = play(DRIVE, 90.0, 0.0) + 0.5 * np.random.default_rng(1).standard_normal(N)
NONE = np.zeros(N, dtype=bool)


def recording(command, measured, simulated, units):
    names = ("handle", "tip")
    channels = (
        Channel(names[0], "command", units[0]),
        Channel(names[1], "measurement", units[1]),
        Channel("fit", "simulation", units[1], of=names[1]),
    )
    columns = {names[0]: command, names[1]: measured, "fit": simulated}
    table = pd.DataFrame({"time_s": np.arange(len(command)) / 100.0, **columns})
    return Recording(with_context(table, channels), channels, "simulated")


def fitted(order, measured=PLAYED, drive=DRIVE):
    return np.polyval(np.polyfit(drive, measured, order), drive)


@pytest.mark.parametrize("order", [1, 3])
@pytest.mark.long
def test_play_half_as_wide_as_the_range_is_named_alone_behind_a_fit(order) -> None:
    (found,) = diagnose(
        DiagnosisConfig(), recording(DRIVE, PLAYED, fitted(order), ("deg", "deg"))
    ).diagnoses
    assert [p.name for p in found.physics] == ["backlash"]
    assert found.physics[0].parameters[0].value == pytest.approx(180.0, rel=0.02)
    assert found.after.heldout_rmse < 1.2 * 0.5


def test_a_spring_that_a_fit_put_in_the_place_of_dry_friction_is_taken_back() -> None:
    x = 0.04 * np.sin(PHASE) * (0.6 + 0.4 * np.cos(PHASE / 3.0))
    speed = np.gradient(x, 0.01)
    force = 280.0 * dragging(x, 0.005, 1.0, None)[0] + 900.0 * speed
    force += 2.0 * np.random.default_rng(2).standard_normal(N)
    (found,) = diagnose(
        DiagnosisConfig(), recording(x, force, fitted(1, force, x), ("m", "N"))
    ).diagnoses
    assert {p.name for p in found.physics} == {"coulomb_friction", "viscous_friction"}
    assert found.calibration.gain == pytest.approx(0.0, abs=0.05)
    assert any("it was left free" in note for note in found.notes)
    assert found.after.heldout_rmse < 1.2 * 2.0


def test_only_what_was_fitted_is_loose() -> None:
    declared = ToleranceConfig()
    assert tolerance_of_fit(declared, PLAYED, DRIVE, DRIVE, NONE) == declared
    straight = tolerance_of_fit(declared, PLAYED, fitted(1), DRIVE, NONE)
    assert straight == replace(declared, gain=straight.gain, offset=straight.offset)
    assert straight.gain > 1.0
    left = np.std(PLAYED - fitted(3))
    assert tolerance_of_fit(declared, PLAYED, fitted(3), DRIVE, NONE).shape > left
    first = np.arange(N) >= 800
    early = np.polyval(np.polyfit(DRIVE[~first], PLAYED[~first], 1), DRIVE)
    assert tolerance_of_fit(declared, PLAYED, early, DRIVE, first).gain > 1.0


@pytest.mark.long
def test_friction_that_turns_round_gradually_takes_the_place_of_rigid_friction() -> None:
    x = 0.04 * np.sin(PHASE) * (0.6 + 0.4 * np.cos(PHASE / 3.0))
    rigid = 250.0 * np.sign(np.gradient(x))
    force = 280.0 * dragging(x, 0.005, 1.0, None)[0]
    force += 2.0 * np.random.default_rng(3).standard_normal(N)
    (found,) = diagnose(DiagnosisConfig(), recording(x, force, rigid, ("m", "N"))).diagnoses
    assert [p.name for p in found.physics] == ["coulomb_friction"]
    assert found.verdict == "explained"
    assert found.after.heldout_rmse < 1.2 * 2.0


@pytest.mark.parametrize(("friction", "mass"), [(0.0, 0.0), (30.0, 0.0), (0.0, 2.0), (30.0, 2.0)])
def test_what_a_simulated_force_goes_by_is_told_beside_its_spring(friction, mass):
    time_s = np.arange(N) / 100.0
    pace = 2.0 * np.pi * np.array([[0.4], [1.1]])
    sines, size = np.sin(pace * time_s), np.array([0.05, 0.02])
    x = size @ sines
    v, a = (
        (size[:, None] * pace * np.cos(pace * time_s)).sum(0),
        (-size[:, None] * pace**2 * sines).sum(0),
    )
    force = 800.0 * x + friction * v + mass * a
    motion = Motion(x, time_s, np.zeros(N, dtype=int), kinetics=Kinetics(v, a, force))
    assert goes_by(motion) == (friction > 0.0, mass > 0.0)


def test_a_simulated_force_that_stays_the_same_goes_by_nothing() -> None:
    """Its variance is that of rounding, which any column of numbers tells a share of."""
    time_s = np.arange(N) / 100.0
    x = 0.05 * np.sin(2.0 * time_s) + 0.02 * np.sin(7.0 * time_s)
    v, a = np.gradient(x, time_s), np.gradient(np.gradient(x, time_s), time_s)
    constant = np.full(N, -6.304765)
    constant[::7] += 1e-15
    motion = Motion(x, time_s, np.zeros(N, dtype=int), kinetics=Kinetics(v, a, constant))
    assert goes_by(motion) == (False, False)

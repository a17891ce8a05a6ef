"""Pulleys and joints that turn hardly once over the drive, in laws that are written here."""

from collections.abc import Callable

import numpy as np
import pytest

from pipeline.config import DiagnosisConfig, ToleranceConfig
from pipeline.discrepancy.model.result import DiagnosisResult
from pipeline.physics.catalogue import BENDS, term
from pipeline.physics.kinematics import CubicCurve
from pipeline.physics.term import Surroundings
from pipeline.stages.diagnosis import diagnose
from tests.discrepancy.made import (
    AMPLITUDE,
    ANGLE,
    NOISE,
    changed,
    names,
    recorded,
    value_of,
)

CURVE = CubicCurve(0.7, 1e-5)


def seen(ahead: Callable[[np.ndarray], np.ndarray], gain: float = 0.05) -> DiagnosisResult:
    """The diagnosis of a drive that runs ahead of what it was told, the gain trusted so far."""
    recording = recorded({}, cycles=9)
    drive = recording.values("pitch_command_deg")
    moved = CURVE(drive + ahead(drive)) - CURVE(drive)
    config = DiagnosisConfig(tolerance=ToleranceConfig(gain=gain))
    return diagnose(config, changed(recording, **{ANGLE: recording.values(ANGLE) + moved}))


@pytest.mark.parametrize(("turns", "phase"), [(0.85, 0.6), (1.05, 0.6), (1.05, 2.5)])
@pytest.mark.long
def test_a_pulley_that_turns_about_once_is_a_ripple_and_no_pile_of_bends(turns, phase):
    period = 2.0 * AMPLITUDE / turns
    result = seen(lambda drive: 3.0 * np.sin(2.0 * np.pi * drive / period + phase))
    assert names(result) == {"transmission_ripple"}
    told = value_of(result, "transmission_ripple", "period")
    assert told.low < period < told.high
    assert result.diagnoses[0].after.heldout_rmse < 1.1 * NOISE


@pytest.mark.parametrize(("gain", "tied"), [(0.1, True), (0.05, False)])
def test_where_a_bend_fits_as_well_it_is_among_the_alternatives(gain, tied):
    """As well: with a gain that is off by no more than the simulation's is trusted."""
    period = 2.0 * AMPLITUDE / 0.85
    result = seen(lambda drive: 3.0 * np.sin(2.0 * np.pi * drive / period + 2.5), gain)
    (found,) = result.diagnoses[0].physics
    assert result.diagnoses[0].verdict == ("ambiguous" if tied else "explained")
    assert "transmission_ripple" in (found.name, *found.alternatives)


def test_a_universal_joint_at_an_angle_is_a_ripple_that_comes_twice_a_turn():
    def ahead(drive: np.ndarray) -> np.ndarray:
        turned = np.radians(drive * 360.0 / 250.0 + 25.0)
        behind = np.arctan2(np.sin(turned) * np.cos(np.radians(38.0)), np.cos(turned))
        return np.degrees(np.unwrap(behind) - turned) * 250.0 / 360.0

    result = seen(ahead)
    assert names(result) == {"transmission_ripple"}
    assert value_of(result, "transmission_ripple", "period").value == pytest.approx(125.0, rel=0.03)


@pytest.mark.parametrize("form", ["long afloat", "long eccentric afloat"])
@pytest.mark.parametrize(("turns", "bends"), [(1.0, False), (0.55, True)])
def test_a_wave_of_which_the_drive_sees_one_bend_may_be_any_other_bend(form, turns, bends):
    around = Surroundings()
    values = np.array([3.0, around.drive_span / turns, 0.5, 0.2])
    also = term("transmission_ripple", form).also_at(values, around)
    assert set(also) == (BENDS if bends else set())

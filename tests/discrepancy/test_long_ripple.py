"""An eccentric pulley that turns hardly once over the drive, in a law that is written here."""

import numpy as np
import pytest

from pipeline.physics.kinematics import CubicCurve
from tests.discrepancy.made import AMPLITUDE, ANGLE, NOISE, changed, diagnosed, names, recorded

CURVE = CubicCurve(0.7, 1e-5)
SIZE_DEG = 3.0


@pytest.mark.parametrize("turns", [0.85, 1.05])
@pytest.mark.parametrize("phase", [0.6, 2.5])
def test_a_pulley_that_turns_about_once_is_a_ripple_and_no_pile_of_bends(turns, phase):
    recording = recorded({}, cycles=9)
    drive = recording.values("pitch_command_deg")
    turned = 2.0 * np.pi * turns * drive / (2.0 * AMPLITUDE) + phase
    ahead = CURVE(drive + SIZE_DEG * np.sin(turned)) - CURVE(drive)
    moved = recording.values(ANGLE) + ahead
    result = diagnosed(changed(recording, **{ANGLE: moved}))
    (diagnosis,) = result.diagnoses
    assert names(result) == {"transmission_ripple"}
    period = next(p for p in diagnosis.physics[0].parameters if p.name == "period")
    assert period.low < 2.0 * AMPLITUDE / turns < period.high
    assert diagnosis.after.heldout_rmse < 1.1 * NOISE

"""Angles of sensors that know one turn."""

import numpy as np
import pytest

from pipeline.discrepancy.problem.turns import leaps_of, unwrapped
from tests.discrepancy.made import ANGLE, SIMULATED, changed, diagnosed, names, recorded, value_of

PLAY = {"backlash": {"width": 4.0}}


def test_an_angle_that_leaps_by_a_turn_is_diagnosed_as_one_that_goes_on() -> None:
    whole = recorded(PLAY)
    angle = np.mod(whole.values(ANGLE) + 0.01, 360.0)
    angle[[200, 333]] = np.nan
    found = diagnosed(changed(whole, **{ANGLE: angle}))
    assert names(found) == {"backlash"}
    assert value_of(found, "backlash", "width").value == pytest.approx(4.0, abs=0.1)
    assert found.diagnoses[0].calibration.offset == pytest.approx(0.41, abs=0.1)
    leaps = leaps_of(angle, 360.0)
    assert f"{ANGLE} leaps by a whole turn {leaps} times" in found.diagnoses[0].notes[0]
    assert leaps > 10


def test_both_may_leap_and_a_measurement_comes_to_its_simulation() -> None:
    whole = recorded(PLAY)
    columns = {name: np.mod(whole.values(name) - 10.0, 360.0) for name in (ANGLE, SIMULATED)}
    recording, leapt = unwrapped(changed(whole, **columns))
    assert set(leapt) == {ANGLE, SIMULATED}
    off = [r.values(ANGLE) - r.values(SIMULATED) for r in (recording, whole)]
    np.testing.assert_allclose(*off, atol=1e-9)


def test_mistakes_and_slips_of_other_sizes_are_no_leaps() -> None:
    values = np.zeros(100)
    values[[20, 50, 51]] = [250.0, 200.0, -230.0]
    values[70:] += 300.0
    assert leaps_of(values, 360.0) == 0
    whole = recorded({})
    recording, leapt = unwrapped(whole)
    assert not leapt
    assert recording.samples.equals(whole.samples)

"""Curves through samples, and plays that wear."""

import numpy as np
import pytest

from pipeline.physics.kinematics import CubicCurve, IdentityCurve, sampled_curve
from pipeline.physics.motion import Motion
from pipeline.physics.tension_loss import TensionLoss

DRIVE = 10.0 * np.sin(np.linspace(0.0, 20.0, 400)) + 2.0
CUBIC = CubicCurve(0.7, 0.002)


@pytest.mark.parametrize("curve", [CUBIC, sampled_curve(DRIVE, CUBIC(DRIVE)), IdentityCurve()])
def test_a_dead_way_is_lost_of_the_drive_and_not_of_its_line(curve):
    lost = np.clip(DRIVE - 1.0, -2.5, 2.5)
    spared = curve(DRIVE - lost) + curve.slope * lost - curve(DRIVE)
    assert curve.spared(DRIVE, 1.0, 2.5) == pytest.approx(spared, abs=1e-12)


@pytest.mark.parametrize(
    ("form", "values", "worn"),
    [
        ("linear", [0.01, 1.0], lambda s: s),
        ("late", [0.01, 1.0, 50.0], lambda s: np.maximum(s - 50.0, 0.0)),
        ("settling", [0.01, 1.0, 80.0], lambda s: -80.0 * np.expm1(-s / 80.0)),
    ],
)
def test_play_is_as_wide_as_its_travel_has_worn_it(form, values, worn):
    motion = Motion(DRIVE, np.arange(400.0), np.zeros(400, dtype=np.int64))
    seen, state = TensionLoss(form).respond(DRIVE, motion, np.array(values), None)
    travel = np.cumsum(np.abs(np.diff(DRIVE, prepend=DRIVE[0])))
    half = 0.5 * (values[1] + values[0] * worn(travel))
    at = DRIVE[0]
    for k, drive in enumerate(DRIVE):
        at = min(max(at, drive - half[k]), drive + half[k])
        assert seen[k] == pytest.approx(at, abs=1e-12)
    assert state == pytest.approx([seen[-1], DRIVE[-1], travel[-1]])

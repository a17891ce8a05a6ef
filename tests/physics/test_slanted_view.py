"""A line that a camera sees aslant: the projection, and that its name is told of lengths."""

from dataclasses import replace

import numpy as np
import pytest

from pipeline.physics.motion import Motion
from pipeline.physics.slanted_view import SlantedView
from pipeline.physics.term import Surroundings
from tests.discrepancy.made import ANGLE, SIMULATED, changed, diagnosed, followed, strokes

TILT, DISTANCE_MM, REACH_MM, NOISE_MM = np.deg2rad(35.0), 90.0, 20.0, 0.05
STROKES, ROWS = 14, 60
MOVED_MM = strokes(np.tile([REACH_MM, -REACH_MM], STROKES // 2), ROWS)
TIME_S = 3.0 * np.arange(len(MOVED_MM))


def pinhole(along_mm: np.ndarray) -> np.ndarray:
    """Where a camera 90 mm off the line's zero has a point of a line tilted by 35 deg."""
    depth = DISTANCE_MM + along_mm * np.sin(TILT)
    return DISTANCE_MM * along_mm * np.cos(TILT) / depth


def test_a_pinhole_camera_is_one_but_for_a_gain():
    motion = Motion(MOVED_MM, TIME_S, np.zeros(len(TIME_S), dtype=np.int64), {})
    seen, _ = SlantedView().respond(MOVED_MM, motion, np.array([np.sin(TILT) / DISTANCE_MM]), None)
    np.testing.assert_allclose(np.cos(TILT) * seen, pinhole(MOVED_MM), rtol=1e-12)


def test_no_slant_within_the_bounds_has_a_pole_in_the_range():
    around = Surroundings(angle_low=-3.0, angle_span=20.0, angle_unit="mm")
    (slant,) = SlantedView().parameters(around)
    assert slant.unit == "1/mm"
    ends = np.array([-3.0, 17.0])
    assert np.all(1.0 + slant.low * ends > 0.2)
    assert np.all(1.0 + slant.high * ends > 0.2)


@pytest.mark.parametrize(("unit", "tells"), [("mm", True), ("N", False), ("count", False)])
def test_only_lengths_are_seen_so(unit: str, tells: bool):
    motion = Motion(MOVED_MM, TIME_S, np.zeros(len(TIME_S), dtype=np.int64), {})
    around = Surroundings(drive_span=40.0, angle_span=40.0, angle_unit=unit)
    assert SlantedView().excited(motion, around) == tells


def test_a_tilted_camera_is_among_what_may_bend_a_length():
    seen = pinhole(MOVED_MM) / np.cos(TILT)
    seen += NOISE_MM * np.random.default_rng(5).standard_normal(len(seen))
    recording = followed(TIME_S, MOVED_MM, seen, 1.0 / (3.0 * 2 * ROWS))
    units = [replace(c, unit="mm") for c in recording.channels]
    recording = changed(replace(recording, channels=tuple(units)), **{SIMULATED: MOVED_MM})
    (found,) = diagnosed(recording).diagnoses
    assert found.measurement == ANGLE
    (named,) = found.physics
    assert "camera_tilt" in {named.name, *named.alternatives}
    assert found.after.heldout_rmse < 1.1 * NOISE_MM

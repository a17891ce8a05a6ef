"""A loop of an elastic wire that rubs all along its sheath."""

import numpy as np

from tests.discrepancy.made import diagnosed, followed, names
from tests.physics.test_sheath_line import at_rest

NOISE, PLACES = 0.03, 11


def test_a_wire_that_rubs_all_along_its_sheath_is_friction_and_nothing_else():
    corners = 10.0 * np.repeat([1.0, 0.68, 0.46, 0.31], 2) * np.tile([1.0, -1.0], 4)
    corners = np.r_[0.0, corners, 0.0]
    way = np.r_[0.0, np.cumsum(np.abs(np.diff(corners)))]
    once = np.interp(np.linspace(0.0, way[-1], 220, endpoint=False), way, corners)
    first, again = np.split(at_rest(np.tile(once, 2), PLACES), 2)
    seen = np.concatenate([first, *[again] * 6]) * 1.01
    drive = np.tile(once, 7)
    seen = seen + NOISE * np.random.default_rng(5).standard_normal(len(seen))
    found = diagnosed(followed(0.05 * np.arange(len(drive)), drive, seen, 1.0 / 11.0))
    assert names(found) == {"friction"}
    assert found.diagnoses[0].verdict == "explained"
    assert found.diagnoses[0].after.heldout_rmse < 1.1 * NOISE

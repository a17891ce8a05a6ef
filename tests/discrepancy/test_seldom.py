"""What is met only where the joint is seldom driven as far."""

import numpy as np
import pytest

from pipeline.discrepancy.search.counted import all_beyond
from tests.discrepancy.made import diagnosed, followed, names, strokes

DRIVE = np.concatenate([np.linspace(0.0, 50.0, 51), np.linspace(49.0, 0.0, 50)])


@pytest.mark.parametrize(
    ("rows", "side", "met"),
    [
        ([48, 49, 50, 51, 52], -1.0, True),
        ([49, 50, 51], 1.0, True),
        ([50, 51], -1.0, False),
        ([47, 48, 49, 50], -1.0, False),
        ([20, 21, 22, 23], -1.0, False),
    ],
    ids=["all beyond", "either side", "two are few", "not on the way back", "elsewhere"],
)
def test_what_stands_off_wherever_the_command_is_beyond_is_no_mistake(rows, side, met):
    off, out = np.full(len(DRIVE), 0.1), np.zeros(len(DRIVE), dtype=bool)
    out[rows] = True
    off[rows] = 4.0 * side
    np.testing.assert_array_equal(all_beyond(DRIVE, off, out), out & met)
    np.testing.assert_array_equal(all_beyond(-DRIVE, off, out), out & met)


def test_what_stands_off_once_at_a_command_that_comes_again_is_a_mistake():
    drive = np.concatenate([DRIVE, DRIVE])
    off, out = np.full(len(drive), 0.1), np.zeros(len(drive), dtype=bool)
    out[48:53], off[48:53] = True, -4.0
    assert not all_beyond(drive, off, out).any()


def test_what_stands_off_there_to_both_sides_is_a_mistake():
    off, out = np.full(len(DRIVE), 0.1), np.zeros(len(DRIVE), dtype=bool)
    out[49:52], off[49:52] = True, [4.0, -4.0, 4.0]
    assert not all_beyond(DRIVE, off, out).any()


def test_a_stop_that_a_few_samples_meet_is_found():
    rng = np.random.default_rng(2)
    reach = np.where(np.isin(np.arange(28), [6, 20]), 52.0, rng.uniform(20.0, 40.0, 28))
    drive = strokes(reach * (-1.0) ** np.arange(28), 50)
    seen = np.minimum(drive, 47.0) + 0.1 * rng.standard_normal(len(drive))
    found = diagnosed(followed(3.36 * np.arange(len(drive)), drive, seen, 0.0015))
    assert "end_stop" in names(found) or "contact" in names(found)
    assert "marker_outliers" not in names(found)
    assert found.diagnoses[0].after.heldout_rmse < 0.115

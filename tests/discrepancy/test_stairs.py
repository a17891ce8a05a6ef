"""A count that is coarse: stairs of one size, flat between their edges."""

import numpy as np
import pytest

from pipeline.physics.off_centre_ripple import STAIRS, OffCentreRipple
from pipeline.physics.term import Surroundings
from tests.discrepancy.made import diagnosed, followed, names

RATE_HZ, STEP, NOISE, AROUND = 100.0, 3.0, 0.12, Surroundings(drive_span=60.0)


@pytest.fixture(scope="module")
def found():
    time_s = np.arange(3000) / RATE_HZ
    drive = 20.0 * np.sin(2.0 * time_s) + 9.0 * np.sin(7.3 * time_s + 1.0)
    seen = STEP * np.round(drive / STEP)
    noise = NOISE * np.random.default_rng(5).standard_normal(len(seen))
    return diagnosed(followed(time_s, drive, 1.01 * seen + noise, 1.0 / np.pi))


def test_it_is_more_than_a_ripple_and_nothing_else(found):
    assert names(found) == {"transmission_ripple"}
    assert found.diagnoses[0].verdict == "partly_explained"
    assert found.diagnoses[0].unexplained.where == STAIRS


def test_it_is_followed(found):
    assert found.diagnoses[0].after.train_rmse < 1.1 * NOISE
    assert found.diagnoses[0].before.train_rmse > 6.0 * NOISE


@pytest.mark.parametrize(
    ("amplitude", "off", "says"),
    [
        (STEP / np.pi, 0.99, STAIRS),
        (STEP / np.pi, 0.8, ""),
        (0.5 * STEP / np.pi, 0.99, ""),
        (STEP / np.pi, -0.99, ""),
    ],
    ids=["stairs", "rounded", "not flat", "the other way"],
)
def test_only_stairs_are_more_than_a_ripple(amplitude, off, says):
    values = np.array([amplitude, STEP, 0.3, off])
    assert OffCentreRipple().beyond_at(values, AROUND) == says

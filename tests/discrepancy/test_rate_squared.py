"""What goes by the square of the speed, where no cycle repeats: names that mop it up go."""

import numpy as np
import pytest

from tests.discrepancy.made import diagnosed, followed, names

SPAN, NOISE, SIZE, LONG_S = 30.0, 0.12, 0.9, 36.0


@pytest.fixture(scope="module", params=[2, 8])
def found(request):
    time_s = np.arange(3600) * 0.01
    pace_hz = 0.3 * 5.0 ** (time_s / LONG_S)
    drive = SPAN * np.sin(2.0 * np.pi * np.cumsum(pace_hz) * 0.01)
    rate = np.gradient(drive, time_s)
    rate /= np.abs(rate).max()
    beside = -rate * np.abs(rate) + 0.6 * np.abs(rate) ** 3 * np.cos(3.0 * drive / SPAN)
    seen = drive + SIZE * beside / np.std(beside)
    rng = np.random.default_rng(request.param)
    return diagnosed(followed(time_s, drive, seen + rng.normal(0.0, NOISE, 3600), 0.5))


@pytest.mark.long
def test_it_is_not_taken_for_the_catalogue(found):
    assert found.diagnoses[0].verdict in ("partly_explained", "unknown_physics")


@pytest.mark.long
def test_no_more_than_one_name_stays_beside_it(found):
    assert len(names(found)) <= 1

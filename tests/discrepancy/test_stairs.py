"""A count that is coarse: stairs of one size, flat between their edges."""

import numpy as np
import pytest

from pipeline.physics.motion import Motion
from pipeline.physics.saw_ripple import STAIRS, SawRipple
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


@pytest.mark.parametrize(("share", "says"), [(1.0, STAIRS), (0.8, ""), (1.2, "")])
def test_only_stairs_are_more_than_a_ripple(share, says):
    values = np.array([share * STEP / np.pi, STEP, 0.3])
    assert SawRipple().beyond_at(values, AROUND) == says


def test_between_two_edges_stairs_are_flat_and_at_these_nothing_is_told():
    stairs, values = SawRipple(), np.array([STEP / np.pi, STEP, 0.0])
    drive = np.linspace(0.05 * STEP, 0.95 * STEP, 50)
    motion = Motion(drive, np.arange(50.0), np.zeros(50, dtype=np.int64))
    np.testing.assert_allclose(
        stairs.respond(drive, motion, values, None)[0], 0.5 * STEP, rtol=0.01
    )
    assert not stairs.at_edge(drive, values).any()
    assert stairs.at_edge(np.array([-0.01, 0.0, 0.01, 0.99]) * STEP, values).all()


def test_stairs_and_a_saw_are_told_in_plain_words():
    saw = SawRipple()
    assert "stairs of 3 deg" in saw.sentence(np.array([STEP / np.pi, STEP, 0.3]), AROUND)
    assert "leaps ahead by 1 deg" in saw.sentence(np.array([1.0 / np.pi, STEP, 0.3]), AROUND)

"""Play whose flanks give within a sample: that is no lag of its own."""

import numpy as np
import pytest

from tests.discrepancy.made import diagnosed, followed, names, value_of

PACE_HZ, STEP_S, WIDTH, NOISE, FINE = 0.125, 0.1, 2.0, 0.05, 40
SETTLING_S = 0.2 * STEP_S


def geared(settling_s: float, step_s: float = STEP_S, rows: int = 1600) -> np.ndarray:
    """Where a load is behind play, its flanks overdamped springs (explicit Euler, fine steps)."""
    fine = np.arange(rows * FINE) * step_s / FINE
    drive = commanded(fine)
    at, out = drive[0], np.empty(len(fine))
    for i, asked in enumerate(drive):
        ahead = asked - at
        beyond = np.sign(ahead) * max(abs(ahead) - 0.5 * WIDTH, 0.0)
        at += min(step_s / FINE / settling_s, 1.0) * beyond
        out[i] = at
    return out[::FINE]


def commanded(time_s: np.ndarray) -> np.ndarray:
    turn = 2.0 * np.pi * PACE_HZ * time_s
    return np.asarray(20.0 * np.sin(turn) + 6.0 * np.sin(3.0 * turn + 0.4))


@pytest.fixture(scope="module")
def found():
    time_s = np.arange(1600) * STEP_S
    seen = geared(SETTLING_S) + NOISE * np.random.default_rng(1).standard_normal(1600)
    return diagnosed(followed(time_s, commanded(time_s), seen, PACE_HZ))


def test_play_whose_flanks_give_is_backlash_and_nothing_else(found):
    assert names(found) == {"backlash"}
    assert found.diagnoses[0].verdict == "explained"
    assert found.diagnoses[0].after.heldout_rmse < 1.1 * NOISE


@pytest.mark.parametrize(("parameter", "value"), [("width", WIDTH), ("settling", SETTLING_S)])
def test_its_width_and_how_soon_it_settles_are_told(found, parameter, value):
    assert value_of(found, "backlash", parameter).value == pytest.approx(value, rel=0.15)


@pytest.mark.long
def test_a_lag_below_the_noise_beside_play_is_the_plays_own():
    """Cycles sampled finely: the load follows within more than half a sample."""
    step_s, rows, settling_s = 0.005, 9600, 0.004
    time_s = np.arange(rows) * step_s
    seen = geared(settling_s, step_s, rows) + NOISE * np.random.default_rng(3).standard_normal(rows)
    found = diagnosed(followed(time_s, commanded(time_s), seen, PACE_HZ))
    assert names(found) == {"backlash"}
    assert value_of(found, "backlash", "settling").value == pytest.approx(settling_s, rel=0.15)

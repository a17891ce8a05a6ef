"""A wire that goes on stretching, in plain cycles: the loop runs the other way."""

import numpy as np
import pytest

from tests.discrepancy.made import ANGLE, NOISE, changed, diagnosed, names, recorded, value_of

SHARE, LATE_S, PARTS = 0.2, 30.0, 40


def sagging(asked: np.ndarray, dwell_s: float) -> np.ndarray:
    """What a joint does whose wire gets longer under its pull, by small steps of each dwell."""
    longer, out = 0.0, np.empty(len(asked))
    for k, there in enumerate(asked):
        for _ in range(PARTS):
            longer += (SHARE * (there - longer) - longer) * dwell_s / LATE_S / PARTS
        out[k] = there - longer
    return out


@pytest.fixture(scope="module")
def found():
    plain = recorded({}, seed=3)
    dwell_s = float(np.median(np.diff(plain.values("time_s"))))
    seen = sagging(plain.values("pitch_angle_sim_deg"), dwell_s)
    noise = NOISE * np.random.default_rng(3).standard_normal(len(seen))
    return diagnosed(changed(plain, **{ANGLE: 1.05 * seen + noise}))


def test_it_is_creep_and_nothing_else(found):
    assert names(found) == {"creep"}
    assert found.diagnoses[0].verdict in ("explained", "ambiguous")
    assert found.diagnoses[0].after.heldout_rmse < 1.1 * NOISE


def test_its_time_constant_is_told(found):
    late = value_of(found, "creep", "time_constant")
    assert late.value == pytest.approx(LATE_S, rel=0.1)
    assert late.low < LATE_S < late.high

"""Creep that stress helps, integrated here: one name, and no friction beside it."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from tests.discrepancy.made import NOISE, diagnosed, followed, names, strokes

SHARE, LATE_S, ACTIVATION = 0.08, 60.0, 3.0


def flown(time_s: np.ndarray, held: np.ndarray) -> np.ndarray:
    """What flows by the hyperbolic sine of what it is behind, after each dwell, (n,)."""
    at, out = held[0], []
    for now, dwell_s in zip(held, np.diff(time_s, prepend=time_s[0] - 1.0), strict=True):

        def speed(_, x, now=now):
            return ACTIVATION / LATE_S * np.sinh((now - x) / ACTIVATION)

        at = solve_ivp(speed, (0.0, dwell_s), [at], "LSODA", rtol=1e-7, atol=1e-8).y[0, -1]
        out.append(at)
    return np.array(out)


@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.long
def test_creep_that_stress_helps_is_creep_and_no_friction(seed):
    drive = strokes(np.array([50.0, -50.0, 0.0] * 9), 50)
    waits = np.tile(np.repeat([2.0, 9.0, 4.0], 150), 3)
    time_s = np.cumsum(waits)
    seen = drive - SHARE * (drive - flown(time_s, drive))
    seen += NOISE * np.random.default_rng(seed).standard_normal(len(drive))
    recording = followed(time_s, drive, 1.01 * seen + 0.3, 0.0)
    samples = recording.samples.assign(cycle=np.arange(len(drive)) // 150)
    result = diagnosed(type(recording)(samples, recording.channels, recording.source))
    (diagnosis,) = result.diagnoses
    assert names(result) == {"creep"}
    assert [p.term.form for p in result.models[0].mechanism.pieces] == ["activated"]
    assert diagnosis.after.heldout_rmse < 1.1 * NOISE

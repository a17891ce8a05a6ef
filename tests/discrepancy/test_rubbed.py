"""A wire that rubs in its sheath ahead of its slack."""

import numpy as np
import pytest

from tests.discrepancy.made import diagnosed, followed, names, value_of

NOISE, LOST, REACH, SLACK = 0.05, 1.8, 0.08, 1.2


def pulled(drive: np.ndarray) -> np.ndarray:
    """The far end of an elastic wire behind Dahl's dry friction, stepped finely."""
    x, z, out = drive[0], 0.0, np.empty(len(drive))
    for k in range(len(drive)):
        start = drive[k - 1] if k else drive[0]
        for part in (np.arange(30) + 1) / 30:
            u = start + part * (drive[k] - start)
            way = np.sign(u - start) or 1.0
            slope = (1.0 - way * z) / REACH
            step = (u - x - 0.5 * LOST * z) / (1.0 + 0.5 * LOST * slope)
            x, z = x + step, z + step / REACH * (1.0 - z * np.sign(step))
        out[k] = x
    return out


@pytest.mark.long
def test_friction_ahead_of_slack_is_no_play_that_grows():
    time_s = 0.02 * np.arange(1600)
    drive = 14.0 * np.exp(-time_s / 25.0) * np.sin(2.0 * np.pi * 0.3 * time_s)
    end = pulled(drive)
    seen = end - np.clip(end, -0.5 * SLACK, 0.5 * SLACK)
    noise = NOISE * np.random.default_rng(1).standard_normal(len(drive))
    found = diagnosed(followed(time_s, drive, seen + noise, 0.3))
    assert names(found) == {"friction", "slack"}
    assert found.diagnoses[0].verdict in ("explained", "ambiguous")
    assert found.diagnoses[0].after.heldout_rmse < 1.1 * NOISE
    assert value_of(found, "friction", "width").value == pytest.approx(LOST, rel=0.03)
    assert value_of(found, "slack", "width").value == pytest.approx(SLACK, rel=0.05)

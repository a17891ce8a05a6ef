"""Friction that is no one distribution of slip elements."""

import numpy as np
import pytest

from tests.discrepancy.made import diagnosed, followed, names, value_of

NOISE, SPAN = 0.1, 30.0


def rubbing(drive: np.ndarray, stiffness: np.ndarray, limit: np.ndarray) -> np.ndarray:
    """A joint on a wire, with Jenkins elements from it to the ground: implicit, by bisection."""
    anchors, out = np.zeros(len(limit)), np.empty(len(drive))
    for k, asked in enumerate(drive):
        low, high = -2.0 * SPAN, 2.0 * SPAN
        for _ in range(50):
            middle = 0.5 * (low + high)
            held = np.clip(stiffness * (middle - anchors), -limit, limit).sum()
            low, high = (low, middle) if middle + held > asked else (middle, high)
        out[k] = 0.5 * (low + high)
        reach = limit / stiffness
        anchors = np.clip(anchors, out[k] - reach, out[k] + reach)
    return out


def test_elements_of_any_strengths_are_friction_and_nothing_else():
    rng = np.random.default_rng(2)
    stiffness, limit = rng.uniform(0.4, 1.0, 12), rng.uniform(0.15, 1.0, 12)
    stiffness, limit = 1.2 * stiffness / stiffness.sum(), 3.0 * limit / limit.sum()
    corners = SPAN * np.array([0, 1, 0.3, 0.75, -0.1, 0.5, -1, -0.3, -0.8, 0.15, -0.5, 0])
    way = np.r_[0.0, np.cumsum(np.abs(np.diff(corners)))]
    drive = np.tile(np.interp(np.linspace(0.0, way[-1], 240, endpoint=False), way, corners), 8)
    seen = 1.01 * rubbing(drive, stiffness, limit) + NOISE * rng.standard_normal(len(drive))
    found = diagnosed(followed(0.05 * np.arange(len(drive)), drive, seen, 0.3))
    assert names(found) == {"friction"}
    assert found.diagnoses[0].verdict == "explained"
    assert found.diagnoses[0].after.heldout_rmse < 1.1 * NOISE
    lost = value_of(found, "friction", "width").value
    lost += value_of(found, "friction", "width in the sheath").value
    assert lost == pytest.approx(6.0, rel=0.1)

"""A loop of Bouc and Wen's model, as a piezo's or a damper's is."""

import numpy as np

from tests.discrepancy.made import diagnosed, followed, names, value_of

NOISE, LETS_GO = 0.02, 2.0


def test_a_loop_that_lets_go_faster_than_it_takes_hold_is_friction():
    """h' = A u' - beta |u'| h - gamma u' |h|, gamma = -beta / 3."""
    corners = 30.0 * np.array([0, 1, 0.3, 0.75, -0.1, 0.5, -1, -0.3, -0.8, 0.15, -0.5, 0])
    way = np.r_[0.0, np.cumsum(np.abs(np.diff(corners)))]
    drive = np.tile(np.interp(np.linspace(0.0, way[-1], 240, endpoint=False), way, corners), 8)
    gives, beta = 0.3, 0.06
    gamma, held = beta * (1.0 - LETS_GO) / (1.0 + LETS_GO), np.zeros(len(drive))
    for k, step in enumerate(np.diff(drive), start=1):
        h = held[k - 1]
        for _ in range(20):
            h += (gives * step - beta * abs(step) * h - gamma * step * abs(h)) / 20
        held[k] = h
    seen = drive - held + NOISE * np.random.default_rng(2).standard_normal(len(drive))
    found = diagnosed(followed(0.05 * np.arange(len(drive)), drive, seen, 1.0 / 12.0))
    assert names(found) == {"friction"}
    assert found.diagnoses[0].after.heldout_rmse < 1.1 * NOISE
    width, release = (value_of(found, "friction", name) for name in ("width", "release"))
    assert width.low < 2.0 * gives / (beta + gamma) < width.high
    assert release.low < LETS_GO < release.high

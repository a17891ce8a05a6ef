"""A load behind a gap of its gears, which friction holds there: play, whatever it looks like."""

import numpy as np
import pytest

from tests.discrepancy.made import diagnosed, followed

STIFF, MOST = np.array([7.0, 4.0, 2.5, 0.4]), np.array([2.0, 2.5, 2.8, 1.5])
HALF, SPRING, NOISE = 2.5, 1.0, 0.2


def behind_a_gap(drive: np.ndarray) -> np.ndarray:
    """Where a load is that a spring with a gap pulls over slip elements, (n,): by bisection."""
    at, bent, out = 0.0, np.zeros(len(STIFF)), []
    for asked in drive:
        low, high = -100.0, 100.0
        while high - low > 1e-9:
            middle = 0.5 * (low + high)
            stretch = asked - middle
            pull = SPRING * (stretch - np.clip(stretch, -HALF, HALF))
            held = np.clip(bent + STIFF * (middle - at), -MOST, MOST).sum()
            low, high = (middle, high) if pull > held else (low, middle)
        bent, at = np.clip(bent + STIFF * (low - at), -MOST, MOST), low
        out.append(low)
    return np.array(out)


@pytest.mark.parametrize("seed", [1, 2])
def test_a_load_that_friction_holds_in_a_gap_has_play(seed):
    time_s = 0.02 * np.arange(1500)
    drive = 40.0 * np.sin(0.2 * np.pi * time_s) + 25.0 * np.sin(0.474 * np.pi * time_s)
    seen = behind_a_gap(drive) + NOISE * np.random.default_rng(seed).standard_normal(len(drive))
    (found,) = diagnosed(followed(time_s, drive, seen, 0.1)).diagnoses
    assert len(found.physics) == 2
    assert any({"friction"} <= {p.name, *p.alternatives} for p in found.physics)
    assert all("backlash" in {p.name, *p.alternatives} for p in found.physics)
    assert found.after.heldout_rmse < 1.15 * NOISE

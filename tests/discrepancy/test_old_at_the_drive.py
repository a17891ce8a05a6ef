"""An old frame of a joint with corners: what the drive asked for then, not what joins samples."""

import numpy as np
import pytest

from tests.discrepancy.made import diagnosed, followed, names, value_of

STEP_S, LATE_S, GAP, NOISE, CYCLES = 0.02, 0.013, 2.5, 0.1, 6


def slacked(drive: np.ndarray) -> np.ndarray:
    return np.asarray(np.sign(drive) * np.maximum(np.abs(drive) - GAP, 0.0))


@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.long
def test_an_old_frame_beside_slack_is_no_lag_of_the_motor(seed: int) -> None:
    """A quick motion: between two samples it goes through half of the slack."""
    time_s = np.arange(CYCLES * 200) * STEP_S
    drive = 40.0 * np.sin(2.0 * np.pi * (0.25 * time_s + 0.11 * (time_s % 4.0) ** 2))
    seen = slacked(np.interp(time_s - LATE_S, time_s, drive))
    seen += NOISE * np.random.default_rng(seed).standard_normal(len(seen))
    found = diagnosed(followed(time_s, drive, seen, 0.25))
    assert names(found) == {"frame_lag", "slack"}
    assert value_of(found, "frame_lag", "lag").value == pytest.approx(LATE_S, rel=0.05)
    assert found.diagnoses[0].after.heldout_rmse < 1.1 * NOISE

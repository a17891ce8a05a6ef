"""A controller's dead band: what it holds until it has fallen behind is no late frame."""

import numpy as np
import pytest

from pipeline.discrepancy.judgement.holding import held_by_chance
from pipeline.discrepancy.problem.late import late_frames
from tests.discrepancy.made import ANGLE, changed, diagnosed, names, recorded
from tests.discrepancy.test_late import CYCLE, EVERY, POSE, N, behind, measured


def held(pose: np.ndarray, bands: np.ndarray) -> np.ndarray:
    """What stays where it is until it is off by more than its band (n,), then goes there at once.

    The band is another one each time it has let go.
    """
    at, out = pose[0], np.empty(len(pose))
    for k, asked in enumerate(pose):
        at = asked if abs(asked - at) > bands[k - 1] else at
        out[k] = at
    return out


def bands_of(width: float, count: int, seed: int) -> np.ndarray:
    return np.abs(width * (1.0 + 0.25 * np.random.default_rng(seed).standard_normal(count)))


def chance(off: np.ndarray) -> float:
    seen = measured(off)
    return held_by_chance(late_frames(seen, POSE, EVERY, 1e-9, CYCLE), seen, POSE, EVERY)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("share", [0.1, 0.3, 0.5])
def test_frames_that_are_late_by_lot_come_wherever_the_joint_is(seed: int, share: float) -> None:
    late = np.random.default_rng(seed).random(N) < share
    assert chance(behind(late.astype(int))) > 1e-3


@pytest.mark.parametrize("seed", range(3))
def test_what_a_dead_band_holds_is_near(seed: int) -> None:
    assert chance(held(POSE, bands_of(1.4, N, seed)) - POSE) < 1e-6


@pytest.mark.parametrize("seed", [1, 2])
def test_a_dead_band_is_told_as_no_late_frames(seed: int) -> None:
    recording = recorded({}, noise=0.1, seed=seed)
    angle = recording.values(ANGLE)
    pose = recorded({}, noise=0.0).values(ANGLE)
    seen = held(pose, bands_of(1.4, len(pose), seed)) + (angle - pose)
    result = diagnosed(changed(recording, **{ANGLE: seen}))
    (diagnosis,) = result.diagnoses
    assert diagnosis.verdict in ("unknown_physics", "partly_explained")
    assert len(names(result)) < 2
    assert "frame_lag" not in names(result)

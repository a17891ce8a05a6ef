"""What a chain does between motor and joint, in laws that are written here: creep, lag, slack."""

from collections.abc import Callable

import numpy as np
import pytest

from pipeline.physics.catalogue import term
from pipeline.physics.motion import Motion
from tests.discrepancy.made import diagnosed, followed, strokes

NOISE, DWELL_S = 0.15, 3.0


def turning(seed: int) -> np.ndarray:
    """A drive that turns at many angles, in steps of many sizes."""
    rng = np.random.default_rng(seed)
    return strokes(rng.uniform(15.0, 50.0, 48) * (-1.0) ** np.arange(48), 28)


def late(drive: np.ndarray, time_constant_s: float) -> np.ndarray:
    """A drive that is held through each dwell, through a low-pass filter."""
    out, left = drive.copy(), np.exp(-DWELL_S / time_constant_s)
    for k in range(1, len(drive)):
        out[k] = drive[k] + (out[k - 1] - drive[k]) * left
    return out


def hurried(drive: np.ndarray) -> np.ndarray:
    """A motor that goes 2 degrees in a dwell and no farther."""
    out = drive.copy()
    for k in range(1, len(drive)):
        out[k] = out[k - 1] + np.clip(drive[k] - out[k - 1], -2.0, 2.0)
    return out


def creeping(drive: np.ndarray, times: int) -> np.ndarray:
    """A tenth of each motion comes with the logarithm of time, over two decades from 4 s on."""
    arms = [late(drive, time_s) for time_s in np.geomspace(4.0, 400.0, times)]
    return 0.9 * drive + 0.1 * np.mean(arms, axis=0)


def loose(angle: np.ndarray) -> np.ndarray:
    """Within 6 degrees about 3 the joint follows by a quarter only."""
    return angle - 0.75 * np.clip(angle - 3.0, -3.0, 3.0)


def seen_bent(asked: np.ndarray) -> np.ndarray:
    """An angle by a curve that saturates."""
    return 40.0 * np.tanh(asked / 45.0)


def found_of(drive: np.ndarray, seen: np.ndarray, simulated: np.ndarray, seed: int) -> set[str]:
    time_s = DWELL_S * np.arange(len(drive))
    noise = NOISE * np.random.default_rng(seed).standard_normal(len(drive))
    recording = followed(time_s, drive, seen + noise, 0.002)
    recording.samples["pitch_angle_sim_deg"] = simulated
    diagnosis = diagnosed(recording).diagnoses[0]
    assert diagnosis.after.heldout_rmse < 1.15 * NOISE
    return {p.name for p in diagnosis.physics}


@pytest.mark.parametrize(
    ("name", "form", "values", "wanted"),
    [
        (
            "creep", "wire spread", [0.1, 40.0, 0.0, 0.0, 1.0],
            lambda u: creeping(u, 5),
        ),
        ("response_lag", "motor first", [2.0], lambda u: late(u, 2.0)),
        ("response_lag", "top speed", [2.0 / DWELL_S], hurried),
        ("slack", "of the joint", [6.0, 1e-3, 0.25, 3.0], loose),
    ],
)  # fmt: skip
def test_the_laws_are_as_written_here(
    name: str, form: str, values: list[float], wanted: Callable[[np.ndarray], np.ndarray]
) -> None:
    drive = turning(3)
    still = np.zeros(len(drive), dtype=int)
    motion = Motion(drive, DWELL_S * np.arange(len(drive)), still, {})
    found = term(name, form).respond(drive, motion, np.array(values), None)[0]
    np.testing.assert_allclose(found, wanted(drive), atol=2e-3)


@pytest.mark.parametrize("seed", [1, 2])
def test_creep_about_as_the_logarithm_of_time_before_a_bent_curve(seed: int):
    drive = turning(seed)
    assert found_of(drive, seen_bent(creeping(drive, 9)), seen_bent(drive), seed) == {"creep"}


@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.long
def test_a_motor_that_is_late_before_wires_that_hang_slack(seed: int):
    drive = turning(seed)
    asked = late(drive, 2.0)
    slack = asked - np.clip(asked, -2.0, 2.0)
    assert found_of(drive, slack, drive, seed) == {"response_lag", "slack"}


@pytest.mark.parametrize("seed", [1, 2])
def test_a_link_that_hangs_loose_on_its_joint_behind_a_bent_curve(seed: int):
    drive = turning(seed)
    angle = seen_bent(drive)
    assert found_of(drive, loose(angle), angle, seed) == {"slack"}


@pytest.mark.parametrize("seed", [1, 2])
def test_a_motor_that_is_too_slow_for_the_larger_steps(seed: int):
    drive = turning(seed)
    assert found_of(drive, hurried(drive), drive, seed) == {"response_lag"}

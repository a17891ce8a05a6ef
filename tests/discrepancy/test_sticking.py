"""A joint that sticks and slips at random: it has play, and more than that."""

import numpy as np
import pytest

from pipeline.discrepancy.judgement.sticking import sticks
from pipeline.discrepancy.judgement.structure import JERKS, STICKY
from tests.discrepancy.made import ANGLE, changed, diagnosed, recorded

COUNT = 1200


def slipped(asked: np.ndarray, rng: np.random.Generator, farthest: float) -> np.ndarray:
    """Where what a wire pulls to `asked` (n,) is, if it lets go at another pull each time."""
    out, at, give = np.empty(len(asked)), asked[0], rng.uniform(0.3, 1.0) * farthest
    for k, there in enumerate(asked):
        if abs(there - at) > give:
            at = there - rng.uniform(0.0, 0.3) * np.sign(there - at) * give
            give = rng.uniform(0.3, 1.0) * farthest
        out[k] = at
    return out


@pytest.mark.parametrize("noise", [0.1, 0.3, 0.6])
def test_steps_that_go_nowhere_are_told_from_noise(noise):
    rng = np.random.default_rng(7)
    way = rng.uniform(0.5, 1.5, COUNT)
    asked = np.cumsum(way)
    errors = np.diff(slipped(asked, rng, 4.0) - asked, prepend=0.0)
    more, share = sticks(errors + noise * rng.standard_normal(COUNT), way)
    assert more > 20.0 > STICKY
    assert 0.1 < share < 0.7


@pytest.mark.parametrize(
    "noise",
    [
        lambda rng: rng.standard_normal(COUNT),
        lambda rng: rng.laplace(size=COUNT),
        lambda rng: np.diff(rng.choice([-1.0, 1.0], COUNT + 1)),
        lambda rng: rng.standard_t(2.5, COUNT),
    ],
    ids=["normal", "peaked", "two zeros", "heavy tails"],
)
@pytest.mark.parametrize("seed", range(5))
def test_noise_that_has_no_side_is_not_stuck(noise, seed):
    rng = np.random.default_rng(seed)
    assert sticks(noise(rng), rng.uniform(0.5, 1.5, COUNT))[0] < 0.5 * STICKY


def test_few_steps_say_nothing():
    assert sticks(np.zeros(0), np.zeros(0)) == (0.0, 0.0)


def test_a_joint_that_slips_from_rest_to_rest_has_play_and_more():
    recording = recorded({}, noise=0.1)
    rng = np.random.default_rng(11)
    stuck = slipped(recording.values("pitch_command_deg"), rng, 7.0)
    off = 0.7 * (stuck - recording.values("pitch_command_deg"))
    (found,) = diagnosed(changed(recording, **{ANGLE: recording.values(ANGLE) + off})).diagnoses
    assert found.verdict in ("unknown_physics", "partly_explained")
    assert found.unexplained.where == JERKS
    assert {p.name for p in found.physics} <= {"backlash", "friction"}

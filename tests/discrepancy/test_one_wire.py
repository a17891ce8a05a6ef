"""Wires that hang slack hold a joint one at a time: what rubs there moves it twice as far.

The balance of two wires and a rubbing joint is written and solved here.
"""

import numpy as np
import pytest
from scipy.optimize import brentq

from pipeline.discrepancy.judgement.notes import ONE_WIRE
from tests.discrepancy.made import SIMULATED, diagnosed, followed

WIRE, GAIN, NOISE = 15.0, 0.7, 0.15
DRAWN_TIGHT, SLACK = 12.0, -1.5
REACHES, HOLDS = np.geomspace(0.8, 8.0, 8), np.full(8, 5.0)


def drive() -> np.ndarray:
    """Nine cycles of 180 steps between -45 and 45 degrees, from 0."""
    cycle = np.concatenate([np.linspace(0, 45, 45, False), np.linspace(45, -45, 90, False),
                            np.linspace(-45, 0, 45, False)])  # fmt: skip
    return np.tile(cycle, 9)


def joint(asked: np.ndarray, tight: float) -> np.ndarray:
    """Angles (n,) of a joint between two wires that pull, but never push, and what rubs there."""
    out, held, last = np.empty(len(asked)), np.zeros(len(REACHES)), 0.0

    def bent(angle: float) -> np.ndarray:
        return np.clip(held + angle - last, -REACHES, REACHES)

    for k, way in enumerate(asked):

        def torque(angle: float, way: float = way) -> float:
            stretch = way - angle / GAIN + angle / (2.0 * WIRE)
            pull = max(tight + stretch, 0.0) - max(tight - stretch, 0.0)
            return float(WIRE * pull - angle - HOLDS / REACHES @ bent(angle))

        found = brentq(torque, last - 30.0, last + 30.0, xtol=1e-9)
        held, last = bent(found), found
        out[k] = found
    return out


@pytest.fixture(scope="module")
def simulated() -> np.ndarray:
    return joint(drive(), DRAWN_TIGHT)


def test_slack_is_not_named_beside_friction_that_it_makes_count_twice(
    simulated: np.ndarray,
) -> None:
    asked = drive()
    seen = joint(asked, SLACK) + NOISE * np.random.default_rng(4).standard_normal(len(asked))
    recording = followed(3.0 * np.arange(len(asked)), asked, seen, 1.0 / 540.0)
    recording.samples[SIMULATED] = simulated
    found = diagnosed(recording).diagnoses[0]
    assert [p.name for p in found.physics] == ["slack"]
    width = next(e for e in found.physics[0].parameters if e.name == "width")
    assert width.low < -2.0 * SLACK < width.high
    assert found.after.heldout_rmse < 1.05 * NOISE
    assert any(ONE_WIRE in note for note in found.notes)


def test_friction_that_is_twice_as_much_is_named_where_both_wires_pull(
    simulated: np.ndarray,
) -> None:
    asked = drive()
    rubs = simulated - GAIN * asked
    seen = simulated + rubs + NOISE * np.random.default_rng(5).standard_normal(len(asked))
    recording = followed(3.0 * np.arange(len(asked)), asked, seen, 1.0 / 540.0)
    recording.samples[SIMULATED] = simulated
    found = diagnosed(recording).diagnoses[0]
    assert [p.name for p in found.physics] == ["friction"]
    assert not any(ONE_WIRE in note for note in found.notes)

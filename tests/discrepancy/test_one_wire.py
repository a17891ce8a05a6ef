"""Wires that hang slack hold a joint one at a time: what rubs there moves it twice as far.

The balance of two wires and a rubbing joint is written and solved here.
"""

import numpy as np
import pytest
from scipy.optimize import brentq

from pipeline.discrepancy.explained import loosened_if_on_one_wire
from pipeline.discrepancy.judgement.notes import ONE_WIRE
from pipeline.discrepancy.model.result import Diagnosis
from pipeline.discrepancy.problem.one_wire import held_by_one_wire
from pipeline.discrepancy.search.explain import explain
from pipeline.recording import Recording
from tests.discrepancy.made import SIMULATED, diagnosed, followed, posed

WIRE, GAIN, NOISE = 15.0, 0.7, 0.15
DRAWN_TIGHT, SLACK, TOE, SOFT = 12.0, -1.5, 3.0, 0.75
REACHES = np.geomspace(0.8, 8.0, 8)


def drive() -> np.ndarray:
    """Nine cycles of 180 steps between -45 and 45 degrees, from 0."""
    cycle = np.concatenate([np.linspace(0, 45, 45, False), np.linspace(45, -45, 90, False),
                            np.linspace(-45, 0, 45, False)])  # fmt: skip
    return np.tile(cycle, 9)


def pull(stretch: float, wire: float, toe: float) -> float:
    """What a wire pulls by that is stretched so far, and soft at first over a toe; never pushes."""
    taut = max(stretch, 0.0)
    lacks = SOFT * toe * (1.0 - np.exp(-taut / toe)) if toe > 0.0 else 0.0
    return wire * (taut - lacks)


def joint(hold: float, tight: float, wire: float = WIRE, toe: float = 0.0) -> np.ndarray:
    """Angles (n,) of a joint between two wires, with eight elements that rub, `hold` each."""
    asked = drive()
    out, held, last = np.empty(len(asked)), np.zeros(len(REACHES)), 0.0

    def bent(angle: float) -> np.ndarray:
        return np.clip(held + angle - last, -REACHES, REACHES)

    for k, way in enumerate(asked):

        def torque(angle: float, way: float = way) -> float:
            stretch = way - angle / GAIN + angle / (2.0 * WIRE)
            pulls = pull(tight + stretch, wire, toe) - pull(tight - stretch, wire, toe)
            return float(pulls - angle - hold * np.sum(bent(angle) / REACHES))

        found = brentq(torque, last - 30.0, last + 30.0, xtol=1e-9)
        held, last = bent(found), found
        out[k] = found
    return out


def recording_of(seen: np.ndarray, simulated: np.ndarray, seed: int) -> Recording:
    asked = drive()
    noise = NOISE * np.random.default_rng(seed).standard_normal(len(asked))
    recording = followed(3.0 * np.arange(len(asked)), asked, seen + noise, 1.0 / 540.0)
    recording.samples[SIMULATED] = simulated
    return recording


def found_of(seen: np.ndarray, simulated: np.ndarray, seed: int) -> Diagnosis:
    return diagnosed(recording_of(seen, simulated, seed)).diagnoses[0]


def said_of_one_wire(found: Diagnosis) -> list[str]:
    return [note.split(ONE_WIRE)[1] for note in found.notes if ONE_WIRE in note]


def test_slack_is_not_named_beside_friction_that_it_makes_count_twice() -> None:
    found = found_of(joint(5.0, SLACK), joint(5.0, DRAWN_TIGHT), 4)
    assert [p.name for p in found.physics] == ["slack"]
    width = next(e for e in found.physics[0].parameters if e.name == "width")
    assert width.low < -2.0 * SLACK < width.high
    assert found.after.heldout_rmse < 1.05 * NOISE
    assert said_of_one_wire(found) == [": 2 times as far."]


@pytest.mark.long
@pytest.mark.parametrize(("wire", "times"), [(WIRE, "2"), (WIRE / 1.6, "3")])
def test_a_soft_wire_without_a_pull_is_alone_too(wire: float, times: str) -> None:
    found = found_of(joint(3.0, 0.0, wire, TOE), joint(3.0, DRAWN_TIGHT), 6)
    assert [p.name for p in found.physics] == ["compliance"]
    assert found.after.heldout_rmse < 1.1 * NOISE
    assert said_of_one_wire(found) == [f": {times} times as far."]


def test_friction_that_is_twice_as_much_is_not_one_wire_alone() -> None:
    simulated = joint(5.0, DRAWN_TIGHT)
    twice = 2.0 * simulated - GAIN * drive()
    found = found_of(twice, simulated, 5)
    assert [p.name for p in found.physics] == ["friction"]
    assert not said_of_one_wire(found)
    on_one = held_by_one_wire(posed(recording_of(twice, simulated, 5)))[0]
    assert not loosened_if_on_one_wire(explain(on_one))

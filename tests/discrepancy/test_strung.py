"""Friction beside a wire that goes on stretching under it: neither is found without the other."""

import numpy as np
import pytest

from pipeline.discrepancy.search.strung import rests_differ
from pipeline.physics.motion import Motion
from tests.discrepancy.made import diagnosed, followed, names, value_of

NOISE, PARTS = 0.3, 20
FIRM, LIMIT, OWN, SHARE, LATE_S = 0.6, 0.8, 0.03, 0.12, 8.0


def commanded(rng: np.random.Generator) -> np.ndarray:
    """Sampled every second: it runs for some samples, then rests for 4 to 50 of them."""
    command = np.zeros(1)
    while len(command) < 1500:
        there = rng.uniform(-20.0, 20.0)
        ramp = np.linspace(command[-1], there, int(rng.integers(2, 5)))[1:]
        command = np.concatenate([command, ramp, np.full(rng.integers(4, 50), there)])
    return command


def pulled(command: np.ndarray, rubs: bool, touches: bool, dwell_s: float = 1.0) -> np.ndarray:
    """Where a joint on such a wire is: a slider and a spring beyond 8, both by small steps."""
    longer = anchor = 0.0
    out = np.empty(len(command))
    for k, there in enumerate(command):
        for part in range(1, PARTS + 1):
            share = min((4.0 if dwell_s == 1.0 else 1.0) * part / PARTS, 1.0)
            before = command[max(k - 1, 0)]
            free = before + (there - before) * share - longer
            for firm, rest in ((0.0, 0.0), (1.5, 8.0)) if touches else ((0.0, 0.0),):
                stuck = (free + FIRM * rubs * anchor + firm * rest) / (1.0 + FIRM * rubs + firm)
                load = np.clip(FIRM * rubs * (stuck - anchor), -LIMIT, LIMIT)
                trial = (free - load + firm * rest) / (1.0 + firm)
                if firm == 0.0 or trial > rest:
                    angle = trial
            load = np.clip(FIRM * rubs * (angle - anchor), -LIMIT, LIMIT)
            anchor = angle - load / FIRM
            load += 1.5 * max(angle - 8.0, 0.0) * touches
            longer += (SHARE * (angle + load / OWN) - longer) * dwell_s / LATE_S / PARTS
        out[k] = angle
    return out


@pytest.mark.long
@pytest.mark.parametrize(
    ("rubs", "touches", "hidden"),
    [(True, False, {"friction", "creep"}), (False, True, {"contact", "creep"})],
)
def test_what_loads_a_wire_that_goes_on_stretching_is_told_beside_it(rubs, touches, hidden):
    rng = np.random.default_rng(4)
    command = commanded(rng)
    seen = 1.03 * pulled(command, rubs, touches) + rng.normal(0.0, NOISE, len(command))
    result = diagnosed(followed(np.arange(float(len(command))), command, seen, 0.0))
    assert names(result) == hidden
    assert result.diagnoses[0].after.heldout_rmse < 1.15 * NOISE
    late = value_of(result, "creep", "time_constant")
    assert late.value == pytest.approx(LATE_S, rel=0.25)
    stiffness = value_of(result, "creep", "stiffness")
    assert stiffness.value == pytest.approx(OWN, rel=0.4)


def test_at_two_frequencies_no_walk_takes_the_place_of_both():
    """Sampled twenty times a second, so that the drive runs from sample to sample."""
    time_s = 0.05 * np.arange(1600)
    turn = 2.0 * np.pi * time_s / 13.0
    command = 14.0 * np.sin(turn) + 6.0 * np.sin(3.1 * turn + 0.7)
    rng = np.random.default_rng(5)
    noise = 0.1 * np.convolve(rng.standard_normal(1604), 0.45 * np.ones(5), "valid")
    seen = 1.03 * pulled(command, rubs=True, touches=False, dwell_s=0.05) + noise
    result = diagnosed(followed(time_s, command, seen, 0.0))
    assert names(result) == {"friction", "creep"}
    assert value_of(result, "creep", "time_constant").value == pytest.approx(LATE_S, rel=0.3)


@pytest.mark.parametrize(
    ("stays", "step_s", "told"), [((1, 4), 3.0, True), ((1,), 3.0, False), ((1,), 0.2, True)]
)
def test_both_are_begun_at_once_only_where_rests_differ_or_are_short(stays, step_s, told):
    drive = np.repeat(np.arange(40.0), np.resize(stays, 40))
    motion = Motion(drive, step_s * np.arange(len(drive)), np.zeros(len(drive), dtype=np.int64))
    assert rests_differ(motion) == told

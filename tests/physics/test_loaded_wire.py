"""A wire that goes on stretching under its load against many small steps in time."""

from itertools import pairwise

import numpy as np
import pytest

from pipeline.physics.contact import Contact
from pipeline.physics.friction import Friction
from pipeline.physics.kinematics import IdentityCurve
from pipeline.physics.loaded_wire import LoadedWire
from pipeline.physics.mechanism import Mechanism
from pipeline.physics.motion import Motion
from pipeline.physics.piece import Piece
from pipeline.physics.term import Surroundings

SHARES, TIMES_S, OWN, FORESEEN, BEGUN = (0.12, 0.05), (6.0, 40.0), 0.04, 0.5, 6.0
WIDTH, REACH = 1.2, 0.8
FIRMNESS, EDGE = 0.4, 4.0
FINE = 200
CORNERS = [0.0, 10.0, -8.0, 6.0, -2.0, 9.0, 0.0]


def motion_of(step_s: float) -> Motion:
    drive = np.concatenate([np.linspace(a, b, 40) for a, b in pairwise(CORNERS)])
    return Motion(drive, step_s * np.arange(len(drive)), np.zeros(len(drive), dtype=int))


def pieces_of(arms: int, load: str) -> list[Piece]:
    form = "loaded wire two" if arms == 2 else "loaded wire"
    more = [SHARES[1], TIMES_S[1]] if arms == 2 else []
    wire = np.array([SHARES[0], TIMES_S[0], OWN, FORESEEN, BEGUN, *more])
    loads = {
        "none": [],
        "rubs": [Piece(Friction("symmetric"), np.array([WIDTH, REACH, 0.0]))],
        "touches": [Piece(Contact("upper"), np.array([FIRMNESS, EDGE, 1e-3]))],
    }
    return [Piece(LoadedWire(form), wire), *loads[load]]


def stretched(motion: Motion, arms: int, load: str, runs: bool) -> np.ndarray:
    """The joint's angle by explicit small steps: the slider mapped back, the wire by Euler."""
    rubs, touches = load == "rubs", load == "touches"
    firm = 0.5 * WIDTH / REACH if rubs else 0.0
    limit = 0.5 * WIDTH if rubs else 0.0
    share, late_s = np.array(SHARES[:arms]), np.array(TIMES_S[:arms])
    asked = motion.drive * (1.0 + FORESEEN * share.sum())
    theta = asked[0] / (1.0 + share.sum())
    longer, anchor = share * theta, theta
    longer += share * BEGUN
    out = np.empty(len(asked))
    for k, ends in enumerate(asked):
        before, dwell = asked[max(k - 1, 0)], motion.dwell_s[k]
        for part in range(1, FINE + 1):
            q = before + (ends - before) * part / FINE if runs else ends
            free = q - longer.sum()
            theta = (free + firm * anchor) / (1.0 + firm)
            force = firm * (theta - anchor)
            if abs(force) > limit:
                force = np.sign(force) * limit
                theta = free - force
                anchor = theta - force / firm if firm else theta
            if touches and theta > EDGE:
                theta = (free + FIRMNESS * EDGE) / (1.0 + FIRMNESS)
                force = FIRMNESS * (theta - EDGE)
            longer = longer + dwell / FINE / late_s * (share * (theta + force / OWN) - longer)
        out[k] = theta
    return out


@pytest.mark.parametrize("arms", [1, 2])
@pytest.mark.parametrize("load", ["none", "rubs", "touches"])
@pytest.mark.parametrize(("step_s", "runs"), [(0.2, True), (3.0, False)])
def test_small_steps_in_time_come_to_the_same(arms, load, step_s, runs):
    motion = motion_of(step_s)
    found = Mechanism(IdentityCurve(), pieces_of(arms, load)).respond(motion)[0]
    expected = stretched(motion, arms, load, runs)
    without = Mechanism(IdentityCurve(), pieces_of(arms, load)[1:]).respond(motion)[0]
    effect = np.ptp(found - without)
    assert effect > 0.4
    np.testing.assert_allclose(found, expected, atol=0.02 * effect)


@pytest.mark.parametrize("step_s", [0.2, 3.0])
def test_it_goes_on_where_it_was(step_s):
    motion, mechanism = motion_of(step_s), Mechanism(IdentityCurve(), pieces_of(2, "rubs"))
    whole, _ = mechanism.respond(motion)
    parts, state = [], None
    for begin, end in pairwise((0, 1, 100, 101, 180, 240)):
        part, state = mechanism.respond(motion.rows(slice(begin, end)), state)
        parts.append(part)
    np.testing.assert_allclose(np.concatenate(parts), whole, atol=1e-9)


def test_a_joint_that_nothing_holds_stays_finite():
    """The wire that hangs slack gives way by more than the joint's own spring takes."""
    slack = Piece(Contact("upper unloading"), np.array([0.14, 8.3, 0.28, 0.1]))
    wire = Piece(LoadedWire(), np.array([0.07, 0.3, 0.02, 0.5, 0.0]))
    found = Mechanism(IdentityCurve(), [slack, wire]).respond(motion_of(0.2))[0]
    assert np.all(np.abs(found) < 50.0)


@pytest.mark.parametrize(
    ("share", "share_2", "late_s", "slight"),
    [(0.05, 0.02, 80.0, False), (0.002, 0.02, 80.0, True), (0.05, 0.02, 4000.0, True)],
)
def test_a_second_stretch_is_none_if_hardly_any_or_too_slow(share, share_2, late_s, slight):
    around = Surroundings(start_s=0.0, end_s=900.0, cycles=9)
    values = np.array([share, 10.0, 0.05, 0.5, 0.0, share_2, late_s])
    assert LoadedWire("loaded wire two").slight(values, around) == slight
    assert not LoadedWire().slight(values[:5], around)

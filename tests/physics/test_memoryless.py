"""A joint without memory: all samples abreast, against the loop that goes from one to the next."""

from itertools import pairwise

import numpy as np
import pytest

from pipeline.physics import balance as at_joint
from pipeline.physics.contact import Contact
from pipeline.physics.coupling import Coupling
from pipeline.physics.creep import Creep
from pipeline.physics.end_stop import EndStop
from pipeline.physics.friction import Friction
from pipeline.physics.gravity import Gravity
from pipeline.physics.mechanism import Mechanism
from pipeline.physics.memoryless import FEWEST
from pipeline.physics.motion import Motion
from pipeline.physics.piece import Piece
from pipeline.physics.slack import Slack
from pipeline.physics.soft_wire import SoftWire
from pipeline.physics.stiffening_joint import StiffeningJoint
from pipeline.physics.tabled import FAR
from pipeline.physics.term import Surroundings

AROUND = Surroundings(drive_low=-60.0, drive_span=120.0, angle_low=-60.0, angle_span=120.0)
TERMS = (
    EndStop("upper"), EndStop("lower"), Contact("upper"), Contact("lower unloading"), Slack(),
    Gravity(), Gravity("unloading"), SoftWire(), SoftWire("toe"), StiffeningJoint(),
    Coupling("yaw"),
)  # fmt: skip


def cycles(samples: int = 1800, apart: int = 1) -> Motion:
    """Nine cycles of +-60 deg, of which only each so manieth sample is kept, and another axis."""
    time_s = 3.0 * np.arange(samples)
    phase = apart * np.arange(samples) / 200.0 % 1.0
    drive = 60.0 * np.interp(phase, [0.0, 0.25, 0.75, 1.0], [0.0, 1.0, -1.0, 0.0])
    others = {"yaw": 20.0 * np.sin(time_s / 50.0)}
    return Motion(drive, time_s, np.zeros(samples, dtype=np.int64), others, 180.0 / np.pi)


def one_by_one(monkeypatch: pytest.MonkeyPatch, mechanism: Mechanism, motion: Motion) -> np.ndarray:
    with monkeypatch.context() as patch:
        patch.setattr(at_joint, "FEWEST", len(motion.drive) + 1)
        return mechanism.respond(motion)[0]


def drawn(rng: np.random.Generator) -> Mechanism:
    """One to three loads with any parameters."""
    pieces = []
    for i in rng.choice(len(TERMS), rng.integers(1, 4), replace=False):
        rows = TERMS[i].parameters(AROUND)
        values = [rng.uniform(p.low, p.high) * rng.choice([0.02, 0.2, 1.0]) for p in rows]
        values = [min(max(v, p.low), p.high) for v, p in zip(values, rows, strict=True)]
        pieces.append(Piece(TERMS[i], np.array(values)))
    return Mechanism(pieces=pieces)


@pytest.mark.parametrize("apart", [1, 7])
def test_all_samples_abreast_are_as_one_by_one(monkeypatch, apart):
    rng, motion = np.random.default_rng(apart), cycles(apart=apart)
    off = []
    for _ in range(60):
        mechanism = drawn(rng)
        abreast = mechanism.respond(motion)[0]
        off.append(np.abs(abreast - one_by_one(monkeypatch, mechanism, motion)).max())
    assert np.median(off) < 2e-6
    assert max(off) < 1e-3, off


def test_a_joint_that_creeps_settles_abreast_as_one_by_one(monkeypatch):
    rng, off = np.random.default_rng(4), []
    for motion in (cycles(), cycles(apart=7)):
        for _ in range(20):
            creep = Piece(Creep(), np.array([rng.uniform(0.0, 0.6), rng.uniform(1.0, 200.0)]))
            mechanism = Mechanism(pieces=[creep, *drawn(rng).pieces])
            abreast = mechanism.respond(motion)[0]
            off.append(np.abs(abreast - one_by_one(monkeypatch, mechanism, motion)).max())
    assert 0.0 < np.median(off) < 2e-6
    assert max(off) < 1e-3, off


def test_where_nothing_touches_a_joint_it_is_as_if_nothing_could():
    motion, sticky = cycles(), Piece(Friction(), np.array([5.0, 4.0, 0.7]))
    free = Mechanism(pieces=[sticky]).respond(motion)[0]
    for angle, ahead in ((70.0, len(free)), (57.0, 46)):
        stop = Piece(EndStop("upper"), np.array([angle, 0.3, 0.02]))
        touched = Mechanism(pieces=[sticky, stop]).respond(motion)[0]
        assert np.all(free[:ahead] < angle - 0.3 * FAR)
        np.testing.assert_allclose(touched[:ahead], free[:ahead], rtol=0.0, atol=1e-12)
    assert np.abs(touched - free).max() > 1.0


@pytest.mark.parametrize(
    "pieces",
    [
        [Piece(EndStop("upper"), np.array([30.0, 0.012, 0.01]))],
        [Piece(Slack(), np.array([0.5, 3.0, 0.012, 0.01]))],
        [Piece(Gravity("unloading"), np.array([14.0, 2.1, 5.0]))],
        [
            Piece(Contact("lower unloading"), np.array([2.0, -10.0, 0.12, 3.0])),
            Piece(SoftWire("toe"), np.array([0.6, 2.0, 0.1, 0.05])),
            Piece(Coupling("yaw"), np.array([3.0, 0.0])),
        ],
    ],
)
def test_sharp_edges_are_met_as_one_by_one(monkeypatch, pieces):
    mechanism = Mechanism(pieces=pieces)
    for motion in (cycles(), cycles(apart=2)):
        abreast = mechanism.respond(motion)[0]
        np.testing.assert_allclose(abreast, one_by_one(monkeypatch, mechanism, motion), atol=2e-4)


def test_abreast_goes_on_block_by_block():
    motion, mechanism = cycles(), Mechanism(pieces=[Piece(Slack(), np.array([8.0, 0, 0.2, 0.05]))])
    whole, end = mechanism.respond(motion)
    first, state = mechanism.respond(motion.rows(slice(0, 700)))
    second, other = mechanism.respond(motion.rows(slice(700, None)), state)
    np.testing.assert_allclose(np.concatenate([first, second]), whole, atol=1e-6)
    np.testing.assert_allclose(other[at_joint.BALANCE], end[at_joint.BALANCE], atol=1e-6)


def test_what_may_have_two_answers_or_remembers_goes_one_by_one(monkeypatch):
    seen = []
    compiled = at_joint.balance
    monkeypatch.setattr(at_joint, "balance", lambda *given: (seen.append(1), compiled(*given))[1])
    heavy, stop = (
        Piece(Gravity(), np.array([120.0, 0.4])),
        Piece(EndStop(), np.array([30, 1, 0.02])),
    )
    sticky = Piece(Friction(), np.array([5.0, 4.0, 0.7]))
    fallen = (
        Piece(Slack(), np.array([8.0, 0.0, 0.2, 0.05])),
        Piece(Gravity(), np.array([20.0, 3.0])),
    )
    for pieces, one in (([stop], 0), ([heavy], 1), ([stop, sticky], 1), (fallen, 1)):
        seen.clear()
        Mechanism(pieces=pieces).respond(cycles())
        assert len(seen) == one
    Mechanism(pieces=[stop]).respond(cycles(FEWEST - 1))
    assert len(seen) == 2


def test_newtons_method_does_not_go_to_and_fro_for_ever(monkeypatch):
    """An S-shaped balance, on which it hops between two angles on both sides of the answer."""
    wire = Piece(SoftWire("toe"), np.array([0.5103, 109.19, 0.0111, 0.01076]))
    touch = Piece(Contact("upper unloading"), np.array([0.5479, 55.71, 1.598, 20.65]))
    drive = np.array([0.0, 100.0, -60.0, 95.0, 0.0, 85.0])
    motion = Motion(drive, np.arange(6.0), np.zeros(6, dtype=np.int64))
    far = Mechanism(pieces=[wire, touch]).respond(motion)[0]
    steps = np.concatenate([np.linspace(a, b, 200) for a, b in pairwise(drive)])
    slow = Motion(steps, np.arange(1000.0), np.zeros(1000, dtype=np.int64))
    near = one_by_one(monkeypatch, Mechanism(pieces=[wire, touch]), slow)[199::200]
    np.testing.assert_allclose(far[1:], near, atol=1e-4)

"""What a joint does again is not worked out again, and is the same."""

from dataclasses import replace

import numpy as np
import pytest

from pipeline.physics import balance as at_joint
from pipeline.physics.contact import Contact
from pipeline.physics.end_stop import EndStop
from pipeline.physics.friction import Friction
from pipeline.physics.mechanism import Mechanism
from pipeline.physics.motion import Motion
from pipeline.physics.piece import Piece
from pipeline.physics.slack import Slack

FRICTION = Piece(Friction(), np.array([5.0, 4.0, 0.7]))
STOP = Piece(EndStop("upper"), np.array([30.0, 0.3, 0.02]))
SLACK = Piece(Slack(), np.array([8.0, 0.0, 0.2, 0.05]))
BRISTLE = Piece(Friction("bristle"), np.array([5.0, 4.0, 0.7]))
PAD = Piece(Contact("upper lossy"), np.array([0.5, 10.0, 1.0, 5.0, 0.5]))
HELD = [(FRICTION,), (BRISTLE,), (FRICTION, STOP), (FRICTION, SLACK), (FRICTION, PAD), (PAD,)]


def cycles(*sizes: float) -> Motion:
    """Cycles of 200 steps from home to both ends and home again, of so many degrees."""
    once = np.interp(np.arange(200) / 200, [0.0, 0.25, 0.75, 1.0], [0.0, 1.0, -1.0, 0.0])
    drive, rows = np.concatenate([size * once for size in sizes]), np.arange(200 * len(sizes))
    return Motion(drive, 3.0 * rows, rows // 200)


def in_one(motion: Motion) -> Motion:
    """The same motion as one long cycle."""
    return replace(motion, cycle=np.zeros_like(motion.cycle))


@pytest.mark.parametrize("pieces", HELD)
def test_cycles_that_begin_and_go_alike_are_as_one_by_one(pieces):
    motion, mechanism = cycles(50, 50, 50, 20, 50, 50, 35, 50, 50), Mechanism(pieces=pieces)
    again, end = mechanism.respond(motion)
    through, last = mechanism.respond(in_one(motion))
    np.testing.assert_allclose(again, through, atol=1e-5)
    np.testing.assert_allclose(end[at_joint.BALANCE], last[at_joint.BALANCE], atol=1e-5)


@pytest.mark.parametrize("pieces", HELD)
def test_a_cycle_is_copied_where_what_is_asked_for_differs_by_nothing(pieces):
    motion = cycles(50, 50, 50, 50)
    near = replace(motion, drive=motion.drive * (1.0 + 1e-9 * (motion.cycle == 3)))
    mechanism = Mechanism(pieces=pieces)
    _, _, before, copied = mechanism.respond(near)[0].reshape(4, 200)
    np.testing.assert_array_equal(copied, before)
    _, _, before, through = mechanism.respond(in_one(near))[0].reshape(4, 200)
    assert np.any(through != before)


def test_a_cycle_that_begins_elsewhere_is_not_copied():
    motion = cycles(50, 50, 50, 50)
    held = Mechanism(pieces=(FRICTION,)).respond(motion)[0].reshape(4, 200)
    assert np.max(np.abs(held[0] - held[1])) > 1.0
    slipped = replace(motion, drive=motion.drive + 0.5 * (motion.cycle > 2))
    moved = Mechanism(pieces=(FRICTION,)).respond(slipped)[0].reshape(4, 200)
    np.testing.assert_allclose(moved[2], held[2], atol=1e-9)
    assert np.max(np.abs(moved[3] - held[3])) > 0.4


def test_it_goes_on_from_a_block_before():
    motion, mechanism = cycles(50, 50, 50, 50, 50, 50), Mechanism(pieces=(FRICTION, STOP))
    whole, end = mechanism.respond(motion)
    first, state = mechanism.respond(motion.rows(slice(0, 730)))
    second, other = mechanism.respond(motion.rows(slice(730, 1200)), state)
    np.testing.assert_allclose(np.concatenate([first, second]), whole, atol=1e-5)
    np.testing.assert_allclose(other[at_joint.BALANCE], end[at_joint.BALANCE], atol=1e-5)

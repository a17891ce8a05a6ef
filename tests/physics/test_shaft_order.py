"""Play and slips on either side of the shaft's ripple."""

import numpy as np
import pytest

from pipeline.physics.backlash import AHEAD
from pipeline.physics.catalogue import term, terms, with_richer
from pipeline.physics.lost_steps import BEHIND
from pipeline.physics.mechanism import Mechanism
from pipeline.physics.piece import Piece
from pipeline.physics.play_operator import play
from pipeline.physics.term import Surroundings
from pipeline.physics.transmission_ripple import rippled
from tests.discrepancy.made import motion_of

MOTION = motion_of(2)
RIPPLE = Piece(term("transmission_ripple", "first"), np.array([2.0, 31.0, 0.4]))
PLAY = Piece(term("backlash"), np.array([6.0]))
WAVE = np.array([[1.0, 2.0, 0.4]])
TURN = 2.0 * np.pi / 31.0
HOME = 2.0 * np.sin(0.4)
AROUND = Surroundings(
    drive_span=110.0,
    drive_low=-55.0,
    start_s=float(MOTION.time_s[0]),
    end_s=float(MOTION.time_s[-1]),
    cycles=2,
    travel=440.0,
)


def answered(*pieces: Piece) -> np.ndarray:
    return Mechanism(pieces=pieces).respond(MOTION)[0]


def test_play_ahead_of_the_ripple_turns_first():
    width = np.array([6.0])
    turned = play(MOTION.drive, 3.0, float(MOTION.drive[0]))
    ahead = answered(RIPPLE, Piece(term("backlash", AHEAD), width))
    np.testing.assert_allclose(ahead, rippled(turned, TURN, WAVE) - HOME)
    usual = answered(RIPPLE, Piece(term("backlash"), width))
    rough = rippled(MOTION.drive, TURN, WAVE) - HOME
    np.testing.assert_allclose(usual, play(rough, 3.0, float(rough[0])))


@pytest.mark.parametrize(
    ("form", "beside"), [("once behind ripple", RIPPLE), ("once behind play", PLAY)]
)
def test_a_slip_behind_something_leaves_it_where_it_was(form, beside):
    jump = np.array([1.5, MOTION.time_s[50]])
    behind = answered(beside, Piece(term("lost_steps", form), jump))
    slipped = 1.5 * (np.arange(len(MOTION)) >= 50)
    np.testing.assert_allclose(behind, answered(beside) + slipped)


def test_a_motor_that_slips_turns_the_play_behind_it_ahead_of_the_ripple():
    jump = np.array([1.5, MOTION.time_s[50]])
    width = np.array([6.0])
    slip, ahead = term("lost_steps", "once"), term("backlash", AHEAD)
    turned = MOTION.drive + 1.5 * (np.arange(len(MOTION)) >= 50)
    expected = rippled(play(turned, 3.0, float(turned[0])), TURN, WAVE) - HOME
    np.testing.assert_allclose(answered(RIPPLE, Piece(ahead, width), Piece(slip, jump)), expected)


BESIDE = {"transmission_ripple": RIPPLE, "play": PLAY}
ELSEWHERE = [t for t in with_richer(terms()) if t.only_beside in BESIDE]


@pytest.mark.parametrize("one", ELSEWHERE, ids=lambda t: f"{t.name}/{t.form}")
def test_a_place_on_the_shaft_makes_a_difference_beside_what_it_says_alone(one):
    usual = next(
        t
        for t in with_richer(terms())
        if any((other.name, other.form) == (one.name, one.form) for other in t.elsewhere())
    )
    values = usual.candidates(MOTION, AROUND)[0]
    if one.name == "lost_steps":
        values[0::2] = -6.0  # back, farther than a step
    assert one.elsewhere() == ()
    assert one.kin == usual.kin
    np.testing.assert_array_equal(answered(Piece(one, values)), answered(Piece(usual, values)))
    beside = BESIDE[one.only_beside]
    apart = answered(Piece(one, values), beside) - answered(Piece(usual, values), beside)
    assert np.ptp(apart) > 1e-3


@pytest.mark.parametrize("behind", BEHIND)
@pytest.mark.parametrize("times", ["once", "twice"])
def test_what_slips_behind_something_is_told_as_the_wire(times, behind):
    slip = term("lost_steps", f"{times}{behind}")
    told = slip.sentence(slip.candidates(MOTION, AROUND)[0], AROUND)
    assert told.startswith("The wire on its pulley slipped by 1.1 deg at ")
    usual = term("lost_steps", times).sentence(slip.candidates(MOTION, AROUND)[0], AROUND)
    assert usual == told.replace("wire on its pulley", "shaft")

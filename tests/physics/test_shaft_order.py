"""Play and slips on either side of the shaft's ripple."""

import numpy as np
import pytest

from pipeline.physics.backlash import AHEAD, play
from pipeline.physics.catalogue import term, terms, with_richer
from pipeline.physics.lost_steps import BEHIND
from pipeline.physics.mechanism import Mechanism, Piece
from pipeline.physics.term import Surroundings
from pipeline.physics.transmission_ripple import rippled
from tests.discrepancy.made import motion_of

MOTION = motion_of(2)
RIPPLE = Piece(term("transmission_ripple", "first"), np.array([2.0, 31.0, 0.4]))
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


def test_a_slip_behind_the_ripple_leaves_it_where_it_was():
    jump = np.array([1.5, MOTION.time_s[50]])
    behind = answered(RIPPLE, Piece(term("lost_steps", f"once{BEHIND}"), jump))
    slipped = 1.5 * (np.arange(len(MOTION)) >= 50)
    np.testing.assert_allclose(behind, rippled(MOTION.drive, TURN, WAVE) - HOME + slipped)


ELSEWHERE = [t for t in with_richer(terms()) if t.only_beside == "transmission_ripple"]


@pytest.mark.parametrize("one", ELSEWHERE, ids=lambda t: f"{t.name}/{t.form}")
def test_without_a_ripple_the_place_on_the_shaft_makes_no_difference(one):
    usual = next(
        t
        for t in with_richer(terms())
        if (other := t.elsewhere()) and (other.name, other.form) == (one.name, one.form)
    )
    values = usual.candidates(MOTION, AROUND)[0]
    assert one.elsewhere() is None
    assert one.kin == usual.kin
    np.testing.assert_array_equal(answered(Piece(one, values)), answered(Piece(usual, values)))
    apart = answered(Piece(one, values), RIPPLE) - answered(Piece(usual, values), RIPPLE)
    assert np.ptp(apart) > 1e-3


@pytest.mark.parametrize("times", ["once", "twice"])
def test_what_slips_behind_the_ripple_is_told_as_the_wire(times):
    slip = term("lost_steps", f"{times}{BEHIND}")
    told = slip.sentence(slip.candidates(MOTION, AROUND)[0], AROUND)
    assert told.startswith("The wire on its pulley slipped by 1.1 deg at ")
    usual = term("lost_steps", times).sentence(slip.candidates(MOTION, AROUND)[0], AROUND)
    assert usual == told.replace("wire on its pulley", "shaft")

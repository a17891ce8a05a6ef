"""More or less of what a simulation itself has."""

from collections.abc import Callable

import numpy as np
import pytest

from pipeline.physics.backlash import Backlash
from pipeline.physics.creep import Creep
from pipeline.physics.friction import Friction
from pipeline.physics.mechanism import Mechanism, OwnCourse
from pipeline.physics.motion import Motion
from pipeline.physics.own_amount import (
    AS_STIFF,
    OwnAmount,
    OwnCreep,
    OwnFriction,
    OwnLag,
    OwnPlay,
    amount_of,
    own_amounts,
)
from pipeline.physics.piece import Piece
from pipeline.physics.response_lag import ResponseLag
from pipeline.physics.second_order_lag import SecondOrderLag
from pipeline.physics.slip_spectrum import AT_DRIVE, AT_JOINT, SlipSpectrum
from pipeline.physics.term import Surroundings

TIME_S = 0.02 * np.arange(900)
MOTION = Motion(
    20.0 * np.sin(0.9 * TIME_S) + 6.0 * np.sin(2.3 * TIME_S),
    TIME_S,
    np.zeros(900, dtype=np.int64),
    {},
)
HOLDS = np.zeros(32)
HOLDS[[5, 14, 22]] = 0.1, 0.4, 0.3
AROUND = Surroundings(drive_unit="mm", angle_unit="deg")


def spectrum(form: str, factor: float = 1.0, reach: float = 1.0) -> Piece:
    return Piece(SlipSpectrum(form), np.r_[0.1 * reach, 10.0 * reach, factor * HOLDS])


def answered(own: OwnCourse, *pieces: Piece) -> np.ndarray:
    return Mechanism(pieces=pieces, course=own).trace(MOTION).seen


def drive(piece: Piece) -> OwnCourse:
    return OwnCourse(drive=(piece,))


def curve(piece: Piece) -> OwnCourse:
    return OwnCourse(curve=(piece,))


def joint(piece: Piece) -> OwnCourse:
    return OwnCourse(joint=(piece,))


@pytest.mark.parametrize(
    ("at", "own", "more", "size", "then"),
    [
        (drive, Piece(Backlash(), np.array([2.0])), OwnPlay(), -0.5,
         Piece(Backlash(), np.array([1.5]))),
        (drive, Piece(Friction("driven"), np.array([2.0, 4.0, 0.3])), OwnFriction(), 1.0,
         Piece(Friction("driven"), np.array([3.0, 4.0, 0.3]))),
        (drive, Piece(Friction("driven"), np.array([2.0, 4.0, 0.3])), OwnFriction(AS_STIFF), 1.0,
         Piece(Friction("driven"), np.array([3.0, 6.0, 0.3]))),
        (drive, spectrum(AT_DRIVE), OwnFriction(), -0.8, spectrum(AT_DRIVE, 0.5)),
        (joint, spectrum(AT_JOINT), OwnFriction(), 0.8, spectrum(AT_JOINT, 1.5)),
        (joint, spectrum(AT_JOINT), OwnFriction(AS_STIFF), -0.8, spectrum(AT_JOINT, 0.5, 0.5)),
        (curve, Piece(ResponseLag("running"), np.array([0.2])), OwnLag(), 0.1,
         Piece(ResponseLag("running"), np.array([0.3]))),
        (curve, Piece(SecondOrderLag(), np.array([8.0, 0.8, 1.0])), OwnLag(), -0.1,
         Piece(SecondOrderLag(), np.array([16.0, 0.8, 1.0]))),
        (curve, Piece(Creep("running"), np.array([0.2, 0.9])), OwnCreep(), -0.1,
         Piece(Creep("running"), np.array([0.1, 0.9]))),
    ],
    ids=["play", "friction", "as stiff", "sliders at the drive", "at the joint",
         "at the joint, as stiff", "lag", "swing", "creep"],
)  # fmt: skip
def test_a_simulation_with_more_or_less_of_its_own_answers_as_one_that_has_that(
    at: Callable[[Piece], OwnCourse], own: Piece, more: OwnAmount, size: float, then: Piece
) -> None:
    changed = answered(at(own), Piece(more, np.array([size])))
    np.testing.assert_allclose(changed, answered(at(then)), atol=1e-9)
    assert np.max(np.abs(changed - answered(at(own)))) > 0.02


@pytest.mark.parametrize(
    ("at", "own", "more"),
    [
        (drive, Piece(Backlash(), np.array([2.0])), OwnPlay()),
        (drive, spectrum(AT_DRIVE), OwnFriction()),
        (joint, spectrum(AT_JOINT), OwnFriction(AS_STIFF)),
        (curve, Piece(ResponseLag("running"), np.array([0.2])), OwnLag()),
    ],
    ids=["play", "friction at the drive", "at the joint", "lag"],
)
def test_none_of_it_is_left_where_that_much_less_is_there(at, own, more):
    bare = answered(OwnCourse())
    np.testing.assert_allclose(
        answered(at(own), Piece(more, np.array([-amount_of(own)]))), bare, atol=1e-9
    )


def test_it_is_only_where_the_simulation_has_some_and_says_how_much_of_what_it_has():
    course = OwnCourse(
        drive=(Piece(Backlash(), np.array([2.0])),),
        curve=(Piece(SecondOrderLag(), np.array([8.0, 0.8, 1.0])),),
        joint=(spectrum(AT_JOINT),),
    )
    own = own_amounts(course.pieces, AROUND)
    assert own["backlash"] == (2.0, "mm")
    assert own["response_lag"] == (pytest.approx(0.2), "s")
    assert own["friction"] == (pytest.approx(1.6), "deg")
    around = Surroundings(drive_unit="mm", own=own)
    assert OwnPlay().excited(MOTION, around)
    assert not OwnCreep().excited(MOTION, around)
    assert not OwnPlay().excited(MOTION, AROUND)
    (width,) = OwnPlay().parameters(around)
    assert (width.unit, width.low, width.high) == ("mm", -2.0, 4.0)
    assert OwnPlay().sentence(np.array([-0.5]), around) == (
        "The simulation has 0.5 mm too much play: it has 2 mm."
    )
    assert "0.1 s too little lag" in OwnLag().sentence(np.array([0.1]), around)


def test_blocks_go_on_where_the_one_before_ended():
    pieces = [Piece(OwnFriction(AS_STIFF), np.array([0.4])), Piece(OwnLag(), np.array([0.05]))]
    course = OwnCourse(
        curve=(Piece(ResponseLag("running"), np.array([0.2])),), joint=(spectrum(AT_JOINT),)
    )
    mechanism = Mechanism(pieces=pieces, course=course)
    whole = mechanism.respond(MOTION)[0]
    first, state = mechanism.respond(MOTION.rows(np.arange(400)))
    on = mechanism.respond(MOTION.rows(np.arange(400, 900)), state)[0]
    np.testing.assert_allclose(np.concatenate([first, on]), whole, atol=1e-6)

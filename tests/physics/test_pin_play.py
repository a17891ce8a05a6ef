"""Play in the joint's pin: as wide in the angle wherever the joint is."""

import numpy as np

from pipeline.physics.backlash import PIN, Backlash
from pipeline.physics.kinematics import CubicCurve
from pipeline.physics.mechanism import Mechanism
from pipeline.physics.motion import Motion
from pipeline.physics.piece import Piece
from pipeline.physics.term import Surroundings

DRIVE = np.concatenate([np.linspace(0.0, 60.0, 61), np.linspace(59.0, -60.0, 120)])
MOTION = Motion(DRIVE, np.arange(181.0), np.zeros(181, dtype=int))
CURVE = CubicCurve(0.7, -1e-4)


def test_a_loop_of_play_in_the_pin_is_as_wide_where_the_curve_is_steep():
    seen = Mechanism(CURVE, (Piece(Backlash(PIN), np.array([2.0])),)).respond(MOTION)[0]
    up, down = seen[10:61], seen[61:111][::-1]
    np.testing.assert_allclose(up, CURVE(DRIVE[10:61]) - 1.0, atol=1e-9)
    np.testing.assert_allclose(down[:40], CURVE(DRIVE[71:111])[::-1][:40] + 1.0, atol=1e-9)


def test_a_block_goes_on_from_the_one_before():
    mechanism = Mechanism(CURVE, (Piece(Backlash(PIN), np.array([2.0])),))
    whole = mechanism.respond(MOTION)[0]
    first, state = mechanism.respond(MOTION.rows(np.arange(80)))
    last = mechanism.respond(MOTION.rows(np.arange(80, 181)), state)[0]
    np.testing.assert_allclose(np.concatenate([first, last]), whole, atol=1e-12)


def test_its_sentence_tells_of_the_joint():
    said = Backlash(PIN).sentence(np.array([2.0]), Surroundings())
    assert said == "What the joint carries turns through 2 deg of play after each reversal."

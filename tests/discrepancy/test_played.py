"""Uneven play at once, where friction beside slack was the easier explanation."""

import numpy as np

from pipeline.discrepancy.fitting.fit import evaluate, improve
from pipeline.discrepancy.fitting.ground import ground_of
from pipeline.discrepancy.search.played import played
from pipeline.discrepancy.search.weighing import names
from pipeline.physics.catalogue import term
from pipeline.physics.piece import Piece
from pipeline.physics.uneven_play import WORN
from tests.discrepancy.made import explained, recorded

PLAY = {"width": 4.0, "unworn": 0.5, "place": 2.0, "reach": 18.0}
LIKE_IT = (("friction", [1.2, 0.1, 0.5]), ("slack/home", [2.0, 0.5, 0.02]))


def test_play_that_is_worn_round_home_is_told_in_place_of_friction_beside_slack():
    found = explained(recorded({f"backlash/{WORN}": PLAY}, cycles=9))
    ground = ground_of(found.problem, found.prior.model, found.used)
    pieces = [Piece(term(*name.split("/")), np.array(values)) for name, values in LIKE_IT]
    mistaken = found.search.weighed(improve(evaluate(ground, pieces)), (0, 0, 0))
    other = played(found.search, mistaken)
    assert names(other) == {"backlash"}
    assert other.score < mistaken.score - 20.0
    (piece,) = other.fit.pieces
    assert piece.term.form == WORN
    np.testing.assert_allclose(piece.values, list(PLAY.values()), rtol=0.15, atol=1.0)


def test_plain_play_is_left_alone():
    found = explained(recorded({"backlash": {"width": 4.0}}))
    assert played(found.search, found.choices[0]) is found.choices[0]


def test_play_in_a_pin_behind_a_bent_curve_is_no_friction() -> None:
    best = explained(recorded({"backlash/pin": {"width": 4.0}}, cycles=9)).choices[0]
    assert [(p.term.name, p.term.form) for p in best.fit.pieces] == [("backlash", "pin")]

"""Two slips at once, where noise that walks was the easier explanation."""

from dataclasses import replace

import numpy as np
import pytest

from pipeline.discrepancy.fitting.fit import evaluate
from pipeline.discrepancy.fitting.ground import ground_of
from pipeline.discrepancy.search.stepped import SHORTEST, stepped, steps
from pipeline.discrepancy.search.weighing import names
from pipeline.physics.catalogue import term
from pipeline.physics.piece import Piece
from tests.discrepancy.made import ANGLE, changed, explained, recorded

SLIPS = {"jump": 1.1, "time": 700.0, "jump_2": -1.0, "time_2": 1500.0}
WALKING = (0, 0, 6)


@pytest.fixture(scope="module")
def found():
    return explained(recorded({"backlash": {"width": 2.0}, "lost_steps/twice": SLIPS}, cycles=9))


@pytest.fixture(scope="module")
def play(found):
    ground = ground_of(found.problem, found.prior.model, found.used)
    return evaluate(ground, [Piece(term("backlash"), np.array([2.0]))])


def test_a_slip_that_is_taken_back_is_told_in_place_of_a_zero_that_walks(found, play):
    walking = found.search.weighed(play, WALKING)
    other = stepped(found.search, walking) if walking.place[2] else None
    assert other is not None
    assert names(other) == {"backlash", "lost_steps"}
    assert other.score < walking.score - 20.0
    slips = next(p for p in other.fit.pieces if p.term.name == "lost_steps")
    assert slips.values == pytest.approx(list(SLIPS.values()), rel=0.1)
    assert other.place[2] == 0


def test_the_two_slips_begin_where_the_zero_moved(play):
    jump, time_s, back, later_s = steps(play, 2)
    assert (time_s, later_s) == pytest.approx((700.0, 1500.0), abs=60.0)
    assert (jump, back) == pytest.approx((1.1, -1.0), abs=0.3)


@pytest.mark.parametrize("count", [2, 4])
def test_as_few_rows_as_have_room_for_slips_do(play, count):
    used = np.zeros_like(play.ground.used)
    used[np.flatnonzero(play.ground.used)[: SHORTEST * (count + 1)]] = True
    few = evaluate(replace(play.ground, used=used), play.pieces)
    times = steps(few, count)[1::2]
    assert np.isfinite(steps(few, count)).all()
    assert np.all(np.diff(times) > 0.0)


def test_teeth_that_a_belt_skips_now_and_then_are_told():
    skips = {"jump": 1.5, "time": 500.0, "jump_2": -1.5, "time_2": 700.0}
    skips |= {"jump_3": -1.5, "time_3": 1900.0}
    best = explained(recorded({"lost_steps/thrice": skips}, cycles=9)).choices[0]
    (piece,) = best.fit.pieces
    assert (piece.term.name, piece.term.form) == ("lost_steps", "thrice")
    np.testing.assert_allclose(piece.values, list(skips.values()), rtol=0.1)


@pytest.mark.parametrize(("form", "jump"), [("every top", 0.5), ("every bottom", -0.5)])
@pytest.mark.long
def test_steps_lost_in_every_cycle_are_told_in_place_of_a_zero_that_walks(form, jump):
    recording = recorded({f"lost_steps/{form}": {"jump": jump, "time": 850.0}}, cycles=9)
    best = explained(recording).choices[0]
    assert names(best) == {"lost_steps"}
    assert best.fit.pieces[0].term.form == form
    assert best.fit.values[0] == pytest.approx(jump, rel=0.1)


def test_steps_lost_in_every_cycle_are_told_beside_a_zero_that_jitters_too():
    hidden = {"backlash": {"width": 2.0}, "lost_steps/every top": {"jump": 0.7, "time": 850.0}}
    recording = recorded(hidden, cycles=9)
    jitter = np.random.default_rng(5).normal(0.0, 0.1, 9)[recording.values("cycle").astype(int)]
    jittering = changed(recording, **{ANGLE: recording.values(ANGLE) + jitter})
    best = explained(jittering).choices[0]
    assert names(best) == {"backlash", "lost_steps"}
    assert "every top" in {p.term.form for p in best.fit.pieces}


@pytest.mark.parametrize("seed", [6, 7])
def test_a_zero_that_moves_ever_faster_is_told_in_place_of_one_that_walks(seed):
    hidden = {"drift/quadratic": {"rate": 0.0, "acceleration": 6.0}}
    best = explained(recorded(hidden, seed=seed)).choices[0]
    assert [(p.term.name, p.term.form) for p in best.fit.pieces] == [("drift", "quadratic")]
    assert best.place[2] == 0


def test_where_the_zero_rests_no_slips_are_looked_for(found):
    calm = found.choices[0]
    assert calm.place[2] == 0
    assert stepped(found.search, calm) is calm


def test_a_wire_that_skips_on_its_eccentric_pulley_now_and_then_is_told_so():
    wheel = {"amplitude": 4.0, "period": 60.0, "phase": 1.0}
    skips = {"jump": 1.5, "time": 500.0, "jump_2": -1.5, "time_2": 700.0}
    skips |= {"jump_3": -1.5, "time_3": 1900.0}
    hidden = {"transmission_ripple": wheel, "lost_steps/thrice behind ripple": skips}
    best = explained(recorded(hidden, cycles=9)).choices[0]
    assert names(best) == {"transmission_ripple", "lost_steps"}
    slips = next(p for p in best.fit.pieces if p.term.name == "lost_steps")
    assert slips.term.form == "thrice behind ripple"
    np.testing.assert_allclose(slips.values, list(skips.values()), rtol=0.15)

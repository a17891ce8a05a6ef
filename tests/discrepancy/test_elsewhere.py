"""Physics that may act at one place of the chain or another."""

import numpy as np
import pytest

from pipeline.discrepancy.fitting.fit import evaluate
from pipeline.discrepancy.search.elsewhere import (
    differing,
    in_better_order,
    there,
    with_others_elsewhere,
)
from pipeline.physics.catalogue import term, terms
from pipeline.physics.piece import Piece
from pipeline.physics.term import HELD
from tests.discrepancy.made import explained, recorded

RIPPLE = {"amplitude": 2.0, "period": 37.0, "phase": 0.5}


@pytest.fixture(scope="module")
def ground():
    return explained(recorded({})).choices[0].fit.ground


def fitted(ground, **pieces):
    return evaluate(ground, [Piece(term(n), np.array(values)) for n, values in pieces.items()])


def test_a_place_is_offered_only_beside_what_it_makes_a_difference_to(ground):
    def only_beside(fit):
        return {t.only_beside for t in differing(terms(["yaw_command_deg"]), fit)} - {""}

    ripple, stop = [1.0, 31.0, 0.0], [30.0, 0.1, 0.1]
    assert only_beside(fitted(ground)) == set()
    assert only_beside(fitted(ground, transmission_ripple=ripple)) == {"transmission_ripple"}
    assert only_beside(fitted(ground, end_stop=stop)) == {HELD}
    assert HELD in there(fitted(ground, end_stop=stop))


def test_all_that_can_is_moved_to_its_other_place(ground):
    fit = fitted(ground, backlash=[2.0], lost_steps=[1.0, 700.0], creep=[0.2, 20.0])
    moved = with_others_elsewhere(fit)
    assert set(moved) == {"transmission_ripple", "play", HELD}
    forms = {p.term.name: p.term.form for p in moved["transmission_ripple"].pieces}
    assert forms == {
        "backlash": "ahead of ripple",
        "lost_steps": "once behind ripple",
        "creep": "one",
    }
    assert {p.term.form for p in moved["play"].pieces} == {"", "once behind play", "one"}
    assert {p.term.form for p in moved[HELD].pieces} == {"", "once", "whole"}


@pytest.mark.parametrize(
    ("key", "size", "parameters"),
    [
        ("backlash/ahead of ripple", "width", {"width": 9.0}),
        ("tension_loss/linear ahead of ripple", "growth", {"width": 3.0, "growth": 4e-3}),
        ("lost_steps/once behind ripple", "jump", {"jump": 3.0, "time": 1100.0}),
    ],
)
@pytest.mark.long
def test_the_order_on_the_shaft_is_found(key, size, parameters):
    ripple = {"transmission_ripple/first": RIPPLE}
    best = explained(recorded(ripple | {key: parameters}, noise=0.15)).choices[0]
    name, _, form = key.partition("/")
    found = next(p for p in best.fit.pieces if p.term.name == name)
    assert set(best.fit.names) == {name, "transmission_ripple"}
    assert found.term.form == form
    told = dict(zip([p.name for p in best.fit.box.parameters], best.fit.values, strict=True))
    assert told[size] == pytest.approx(parameters[size], rel=0.1)


def test_of_two_orders_on_the_shaft_the_better_one_is_followed(ground):
    ripple = [1.0, 31.0, 0.0]
    fits = [
        fitted(ground, transmission_ripple=ripple, backlash=[4.0]),
        evaluate(
            ground,
            [
                Piece(term("transmission_ripple"), np.array(ripple)),
                Piece(term("backlash", "ahead of ripple"), np.array([1.0])),
            ],
        ),
        fitted(ground, transmission_ripple=ripple, creep=[0.1, 20.0]),
    ]
    kept = in_better_order({fit.key: fit for fit in fits})
    worse = max(fits[:2], key=lambda fit: fit.cost)
    assert len(kept) == 2
    assert not any(fit is worse for fit in kept)

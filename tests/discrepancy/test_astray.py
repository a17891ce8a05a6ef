"""Explanations that went astray, from which no single swap leads: some of it is begun again."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from pipeline.discrepancy.fitting.fit import evaluate, improve
from pipeline.discrepancy.search.equivalents import equivalents
from pipeline.discrepancy.search.explain import Explanation
from pipeline.discrepancy.search.one_late import one_late
from pipeline.discrepancy.search.plain_forms import begun_plainly, in_plain_forms
from pipeline.discrepancy.search.redrawn import redrawn
from pipeline.discrepancy.search.refuted import refuted
from pipeline.discrepancy.search.second_order import swinging
from pipeline.discrepancy.search.weighing import Choice
from pipeline.physics.catalogue import BENDS, term
from pipeline.physics.piece import Piece
from tests.discrepancy.made import explained, recorded

Told = Sequence[tuple[str, str, list[float]]]
TOE = {"softness": 0.3, "reach": 9.0, "stretch": 0.03, "stiffness": 0.08}
CREEP = ("creep", "one", [0.8, 8.7])


def begun(found: Explanation, told: Told, place=(0, 0, 0)) -> Choice:
    """What such terms come to on the ground of an explanation."""
    pieces = [Piece(term(name, form), np.array(values)) for name, form, values in told]
    fit = improve(evaluate(found.choices[0].fit.ground, pieces))
    return found.search.weighed(fit, place, 12)


@pytest.mark.parametrize(
    ("seed", "hidden", "told", "names"),
    [
        (
            0,
            {"response_lag/first": {"time_constant": 11.0}, "compliance/toe": TOE},
            [CREEP, ("response_lag", "whole", [2.7]), ("compliance", "toe", list(TOE.values()))],
            {"response_lag", "compliance"},
        ),
        (
            3,
            {"creep/one": {"share": 0.29, "time_constant": 13.0}, "slack/home": {"width": 12.0}},
            [
                ("response_lag", "first", [3.2]),
                ("creep", "whole", [0.04, 40.0]),
                ("slack", "home", [12.0, 0.16, 0.016]),
            ],
            {"creep", "slack"},
        ),
    ],
)
@pytest.mark.long
def test_two_that_come_late_are_one_that_acts_where_loads_bear_on_it(seed, hidden, told, names):
    found = explained(recorded(hidden, seed=seed, noise=0.15))
    two = begun(found, told)
    one = one_late(found.search, two)
    assert set(one.fit.names) == names
    assert one.score < two.score - 20.0
    assert one_late(found.search, one) is one


def test_a_contact_that_took_a_part_of_a_bend_is_drawn_anew():
    contact = {"stiffness": 1.5, "angle": 10.5, "skin": 0.3, "pretension": 8.5}
    hidden = {"contact/upper unloading": contact, "gravity/": {"deflection": 12.0, "zero": 1.4}}
    found = explained(recorded(hidden, noise=0.25))
    wide = ("contact", "upper unloading", [2.1, 12.9, 2.4, 1.1])
    two = begun(found, [wide, ("transmission_ripple", "first", [0.6, 73.6, 3.7])])
    drawn = redrawn(found.search, two)
    assert "contact" in drawn.fit.names
    assert set(drawn.fit.names) & BENDS
    assert drawn.score < two.score - 20.0


def test_rich_forms_beside_a_zero_that_walks_are_begun_again_as_plain_ones():
    hidden = {
        "creep/one": {"share": 0.24, "time_constant": 36.0},
        "backlash/": {"width": 1.0},
    }
    found = explained(recorded(hidden, noise=0.13))
    spread = ("creep", "wire spread", [0.8, 1.7, 0.7, -30.0, 1.5])
    told = [spread, ("backlash", "worn round", [1.9, 0.4, -1.2, 25.0])]
    astray = begun(found, told, (0, 0, 7))
    plain = in_plain_forms(found.search, astray.fit)
    usual = {(t.name, t.form) for t in found.search.terms}
    assert plain.key <= usual
    assert not astray.fit.key & usual
    family = found.search.family
    unrepeated = replace(family, prior=replace(family.prior, repeats=0))
    best = begun_plainly(replace(found.search, family=unrepeated), [astray])[0]
    assert astray.place[2] > 0
    assert refuted(found.search, astray)
    assert begun_plainly(found.search, [astray]) == [astray]
    tied = {"backlash", "friction", *equivalents("backlash", found.problem)}
    assert "creep" in best.fit.names
    assert len(best.fit.names) == 2
    assert set(best.fit.names) & tied
    assert best.place[2] == 0
    assert best.score < astray.score - 20.0


def test_a_loop_that_is_a_swing_in_truth_is_told_though_nothing_speaks_against_the_noise():
    swing = {"natural_frequency": 0.39, "damping": 0.46, "moving": 0.1}
    tilt = ("camera_tilt", "", [0.42, -1.0])
    hidden = {"response_lag/second": swing, "camera_tilt/": {"tilt": 0.42, "direction": -1.0}}
    found = explained(recorded(hidden, noise=0.17))
    loop = begun(found, [tilt, ("friction", "wrapped", [0.35, 0.09, 0.0, 0.02])])
    assert not refuted(found.search, loop)
    best = swinging(found.search, [loop])[0]
    assert set(best.fit.names) == {"response_lag", "camera_tilt"}
    assert best.score < loop.score - 5.0
    assert swinging(found.search, [best])[0] is best

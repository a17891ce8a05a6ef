"""Slack beside what takes its place at first."""

import numpy as np
import pytest

from pipeline.discrepancy.fitting.fit import evaluate, improve
from pipeline.discrepancy.search.disguise import plainly
from pipeline.discrepancy.search.exchange import exchanged
from pipeline.discrepancy.search.moves import parted
from pipeline.discrepancy.search.ties import standing
from pipeline.physics.catalogue import term
from pipeline.physics.piece import Piece
from pipeline.physics.term import Surroundings
from tests.discrepancy.made import explained, motion_of, recorded


@pytest.mark.parametrize(
    ("key", "parameters", "other"),
    [
        ("slack/driven", {"width": 1.2, "rounding": 0.02}, {"coupling/yaw_command_deg/play": {}}),
        ("slack/ahead of play", {"width": 4.0, "rounding": 0.1}, {"backlash": {"width": 3.0}}),
        (
            "slack/ahead of play",
            {"width": 8.0, "rounding": 0.1, "kept": 0.4},
            {"backlash": {"width": 2.0}},
        ),
    ],
)
@pytest.mark.long
def test_slack_of_the_drive_is_found_beside_what_it_does_not_answer_to(key, parameters, other):
    found = explained(recorded({key: parameters, **other}, noise=0.15, two_axes=True))
    best, beside = found.choices[0], next(iter(other)).partition("/")[0]
    assert set(best.fit.names) == {"slack", beside}
    slack = next(p for p in best.fit.pieces if p.term.name == "slack")
    assert slack.term.form.removesuffix(" off home") == key.partition("/")[2]
    np.testing.assert_allclose(slack.values[0], parameters["width"], rtol=0.1, atol=0.1)


def test_slack_and_a_bend_are_found_though_one_term_comes_near_both():
    hidden = {
        "slack/home": {"width": 2.2, "rounding": 0.05, "stiffness": 0.01},
        "lens_distortion": {"distortion": 4.5e-5},
    }
    found = explained(recorded(hidden))
    ground = found.choices[0].fit.ground
    stretched = Piece(term("compliance", "driven"), np.array([0.5, 29.0, 0.6, 0.0]))
    one = found.search.weighed(improve(evaluate(ground, [stretched]), 20), (0, 0, 0))
    both = parted(found.search, one)
    assert set(found.choices[0].fit.names) == {"slack", "lens_distortion"}
    assert "slack" in both.fit.names
    assert both.score < one.score - 50.0
    assert parted(found.search, both) is both


def test_wire_that_is_soft_near_home_alone_may_be_slack():
    hidden = {"slack/driven": {"width": 1.5, "rounding": 2.0}}
    found = explained(recorded(hidden, noise=0.05))
    best = found.choices[0]
    (name,) = best.fit.names
    told = {name, *standing(name, best, found.choices, found.problem).alternatives}
    assert told >= {"slack", "compliance"}


@pytest.mark.parametrize(("width", "name"), [(4.0, "slack"), (0.001, "compliance")])
def test_a_width_that_is_not_worth_a_parameter_is_soft_wire(width, name):
    found = explained(recorded({"slack/driven": {"width": 4.0, "rounding": 0.2}}))
    values = np.array([width, 0.2, 0.1])
    fit = evaluate(found.choices[0].fit.ground, [Piece(term("slack", "driven"), values)])
    assert plainly(fit) == [name]


@pytest.mark.parametrize("beside", [{}, {"drift/exponential": {"amplitude": -3.0}}])
def test_creep_that_grows_with_the_pull_is_no_friction_that_does(beside):
    hidden = {"creep/rising": {"share": 0.0, "time_constant": 28.0, "rise": 0.002}}
    found = explained(recorded(hidden | beside, noise=0.1))
    best = found.choices[0]
    creep = next(p for p in best.fit.pieces if p.term.name == "creep")
    assert set(best.fit.names) == {"creep"} | {key.partition("/")[0] for key in beside}
    np.testing.assert_allclose(creep.values[[1, -1]], [28.0, 0.002], rtol=0.2)


def test_a_late_motor_beside_slack_is_told_in_place_of_creep_that_grows_with_the_pull():
    hidden = {
        "slack": {"width": 6.0, "centre": 8.0},
        "response_lag/motor": {"natural_frequency": 0.3, "damping": 1.0, "moving": 0.0},
    }
    found = explained(recorded(hidden, noise=0.1))
    ground = found.choices[0].fit.ground
    slack = next(p for p in found.choices[0].fit.pieces if p.term.name == "slack")
    creep = Piece(term("creep", "rising"), np.array([0.5, 4.0, 0.0, 0.0, 0.001]))
    mistaken = found.search.weighed(improve(evaluate(ground, [slack, creep]), 20), (0, 0, 0))
    other = exchanged(found.search, mistaken)
    assert {(p.term.name, p.term.form) for p in other.fit.pieces} >= {("response_lag", "motor")}
    assert other.score < mistaken.score - 20.0


def test_wire_that_stiffens_at_once_where_another_spring_takes_over_is_compliance():
    hidden = {"compliance/driven": {"softness": 0.25, "reach": 18.0, "abruptness": 30.0}}
    best = explained(recorded(hidden, noise=0.1)).choices[0]
    assert best.fit.names == ("compliance",)


@pytest.mark.parametrize(("low", "near"), [(0.0, True), (-3.0, True), (2.0, True), (20.0, False)])
def test_slack_round_home_shows_where_the_drive_comes_near_that_from_one_side(low, near):
    around = Surroundings(drive_span=100.0, drive_low=low)
    assert term("slack", "home").excited(motion_of(), around) == near

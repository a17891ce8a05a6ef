"""Names that are another one in disguise."""

from dataclasses import replace

import numpy as np
import pytest

from pipeline.discrepancy.fitting.fit import evaluate, improve
from pipeline.discrepancy.fitting.ground import Ground, ground_of
from pipeline.discrepancy.model.intervals import covariance_of
from pipeline.discrepancy.noise.noise import NoiseModel
from pipeline.discrepancy.search.disguise import (
    first_step,
    maybe_themselves,
    plainly,
    undisguised,
    variance_given,
    where_acting,
)
from pipeline.discrepancy.search.weighing import Choice
from pipeline.physics.catalogue import term
from pipeline.physics.piece import Piece
from tests.discrepancy.made import NOISE, chosen, posed, recorded


@pytest.fixture(scope="module")
def ground() -> Ground:
    problem = posed(recorded({"backlash": {"width": 2.0}}))
    return ground_of(problem, NoiseModel(NOISE), problem.train)


@pytest.mark.parametrize(("deviations", "name"), [(2.2, "backlash"), (3.5, "tension_loss")])
def test_a_play_whose_growth_is_not_worth_a_parameter_is_backlash(ground, deviations, name):
    def grown(growth):
        return evaluate(ground, [Piece(term("tension_loss"), np.array([growth, 1.9]))])

    deviation = np.sqrt(covariance_of(grown(1e-5))[2, 2])
    assert plainly(grown(deviations * deviation)) == [name]


@pytest.mark.parametrize("form", ["linear", "cycle", "late", "settling"])
@pytest.mark.parametrize(("growing", "said"), [(0.1, False), (1.2, True)])
def test_a_play_of_which_half_may_have_grown_may_be_one_that_grows(ground, form, growing, said):
    """What it may have grown by is the 95 % interval's upper end; the width here is 2 deg."""
    around, physics = ground.problem.around, term("tension_loss", form)
    course = {"late": [400.0], "settling": [700.0]}.get(form, [])
    way = physics.grown_a_growth(np.array([0.0, 0.0, *course]), around)
    fit = evaluate(ground, [Piece(physics, np.array([growing / way, 2.0 - growing, *course]))])
    told = maybe_themselves(Choice(fit, (0, 0, 0), 0.0))
    assert told == ({"tension_loss"} if said else set())


def test_a_growth_that_is_surely_there_stays_one_where_its_course_is_unsure(ground):
    """One that begins faster and settles sooner looks nearly the same."""

    def grown(growth):
        return evaluate(ground, [Piece(term("tension_loss", "settling"), growth)])

    unsure = np.array([0.0008, 1.9, 700.0])
    covariance = covariance_of(grown(unsure))
    alone = np.sqrt(variance_given(covariance, 2, np.array([4])))
    assert plainly(grown(unsure)) == ["tension_loss"]
    assert 4.0 * alone < unsure[0] < 2.0 * np.sqrt(covariance[2, 2])


@pytest.mark.parametrize(("stretch", "name"), [(0.06, "slack"), (0.0, "compliance")])
def test_wire_that_gives_way_within_a_step_and_no_more_hung_slack(ground, stretch, name):
    """A free joint would take up the same toe over 1.6 deg, beyond a step of 1.3 deg."""
    wire = Piece(term("compliance", "wire"), np.array([0.3, 1.6, stretch, 0.006]))
    assert plainly(evaluate(ground, [wire])) == [name]


def test_a_toe_hung_no_slack_as_it_hardens_on_the_way(ground):
    toe = Piece(term("compliance", "toe"), np.array([0.23, 3.0, 0.018, 0.003]))
    assert plainly(evaluate(ground, [toe])) == ["compliance"]


def test_a_name_is_told_as_what_it_hides_only_where_that_explains_as_well(ground):
    growing = chosen(ground, 0.0, tension_loss=[1e-7, 1.9])
    plain_play = chosen(ground, 10.0, backlash=[2.0])
    assert undisguised([growing, plain_play]) is plain_play
    assert undisguised([growing, replace(plain_play, score=60.0)]) is growing


def test_names_that_each_hide_the_other_are_told_as_the_form_that_hides_none(ground):
    def told(name, form, values, score):
        piece = Piece(term(name, form), np.array(values))
        return Choice(evaluate(ground, [piece]), (0, 0, 0), score)

    gentle = told("slack", "driven", [0.95, 0.57, 0.0], 0.0)
    sudden = told("compliance", "wire", [0.3, 1.6, 0.06, 0.006], 5.0)
    taut = told("slack", "home", [4.0, 0.1, 0.02], 9.0)
    assert [plainly(c.fit) for c in (gentle, sudden)] == [["compliance"], ["slack"]]
    assert plainly(taut.fit) == ["slack"]
    assert undisguised([gentle, sudden, taut]) is taut
    assert undisguised([gentle, sudden]) is sudden


@pytest.mark.parametrize(("reach", "name"), [(0.1, "backlash"), (0.9, "friction")])
def test_corners_within_a_step_are_sharp_unless_the_data_show_them_rounded(reach, name):
    recording = recorded({"friction": {"width": 2.0, "reach": reach, "spread": 0.0}}, noise=0.05)
    problem = posed(recording)
    seen = ground_of(problem, NoiseModel(0.05, 0.0, 0.0), problem.train)
    fit = improve(evaluate(seen, [Piece(term("friction"), np.array([2.0, reach, 0.0]))]))
    step = where_acting(first_step(problem.motion.drive), fit, term("friction"))
    assert fit.pieces[0].values[1] < step
    assert plainly(fit) == [name]


def test_a_drive_that_goes_round_its_turns_slowly_shows_more_than_its_usual_step():
    turns = np.arange(800)
    wave, even = 50.0 * np.sin(turns / 20.0), 50.0 - np.abs(turns % 160 - 80.0) * 1.25
    assert first_step(even) == pytest.approx(1.25)
    assert first_step(wave) < 0.1 < np.median(np.abs(np.diff(wave)))
    assert first_step(np.zeros(9)) == 0.0


def test_a_step_is_one_of_the_drive_before_the_curve_and_one_of_the_angle_behind(ground):
    fit, around = evaluate(ground, []), ground.problem.around
    assert where_acting(2.0, fit, term("friction", "driven")) == 2.0
    behind = where_acting(2.0, fit, term("friction"))
    assert behind == pytest.approx(2.0 * around.angle_span / around.drive_span)
    assert behind < 1.8

"""Ties: what could stand in the place of a name."""

from dataclasses import replace

import numpy as np
import pytest

from pipeline.discrepancy.fitting.fit import evaluate
from pipeline.discrepancy.fitting.ground import Ground, ground_of
from pipeline.discrepancy.noise.noise import NoiseModel
from pipeline.discrepancy.search.disguise import (
    plainly,
)
from pipeline.discrepancy.search.equivalents import equivalents
from pipeline.discrepancy.search.ties import standing
from pipeline.discrepancy.search.weighing import Choice
from pipeline.physics.catalogue import term
from pipeline.physics.piece import Piece
from tests.discrepancy.made import (
    NOISE,
    changed,
    chosen,
    diagnosed,
    followed,
    names,
    posed,
    recorded,
)


@pytest.fixture(scope="module")
def ground() -> Ground:
    problem = posed(recorded({"backlash": {"width": 2.0}}))
    return ground_of(problem, NoiseModel(NOISE), problem.train)


def test_two_names_that_two_others_could_stand_for_are_tied(ground):
    best = chosen(ground, 0.0, backlash=[2.0], drift=[0.5])
    far = chosen(ground, 30.0, friction=[2.0, 1.0, 0.7], drift=[0.5])
    both = chosen(ground, 5.0, friction=[2.0, 9.0, 0.7], lost_steps=[0.5, 900.0])
    found = standing("drift", best, [best, both, far], ground.problem)
    assert found.tied
    assert found.alternatives[:2] == ("friction", "lost_steps")
    assert not standing("drift", best, [best, replace(both, score=30.0)], ground.problem).tied


@pytest.mark.parametrize(("score", "said"), [(-3.0, True), (12.0, True), (16.0, False)])
def test_friction_sharper_than_a_step_may_be_what_looks_like_play(ground, score, said):
    play = chosen(ground, 0.0, backlash=[2.0])
    finer = chosen(ground, score, friction=[1.4, 0.08, 0.0])
    assert plainly(finer.fit) == ["backlash"]
    found = standing("backlash", play, [play, finer], ground.problem)
    assert (found.alternatives[0] == "friction") == said
    assert found.tied == (score < 0.0)


@pytest.mark.parametrize(("growth", "noise", "tied"), [(4e-4, 3.0, True), (1e-5, NOISE, False)])
def test_play_that_may_have_grown_to_half_of_its_width_ties_with_one_that_grows(
    growth, noise, tied
):
    problem = posed(recorded({"backlash": {"width": 2.0}}, noise=noise))
    ground = ground_of(problem, NoiseModel(noise), problem.train)
    play = chosen(ground, 0.0, backlash=[2.0])
    growing = chosen(ground, 4.0, tension_loss=[growth, 1.6])
    assert plainly(growing.fit) == ["backlash"]
    found = standing("backlash", play, [play, growing], problem)
    assert found.tied == tied
    assert ("tension_loss" in found.alternatives) == tied
    far = replace(growing, score=12.0)
    assert not standing("backlash", play, [play, far], problem).tied


def test_friction_that_can_be_no_sharper_is_no_tie_of_play_however_well_it_fits(ground):
    (_, reach, *_) = term("friction").parameters(ground.problem.around)
    play = chosen(ground, 0.0, backlash=[2.0])
    sharpest = chosen(ground, -3.0, friction=[1.4, reach.low, 0.0])
    found = standing("backlash", play, [play, sharpest], ground.problem)
    assert "friction" in found.alternatives
    assert not found.tied


def test_what_may_be_play_may_be_friction_but_play_by_itself_says_whether_it_is_sharp():
    """At one dwell and one step; the paper's cycles."""
    problem = posed(recorded({}))
    assert equivalents("frame_lag", problem) == ["backlash", "friction", "response_lag"]
    assert equivalents("backlash", problem) == ["frame_lag", "response_lag"]


@pytest.mark.parametrize(("score", "said"), [(14.0, True), (30.0, False)])
def test_an_old_frame_may_be_a_lag_that_is_charged_for_more_parameters(score, said):
    recording = recorded({})
    longer = np.where(recording.values("cycle") % 2 == 1, 4.0, 1.0)
    problem = posed(changed(recording, time_s=np.cumsum(3.36 * longer)))
    assert not equivalents("frame_lag", problem)
    ground = ground_of(problem, NoiseModel(NOISE), problem.train)
    frame = chosen(ground, 0.0, frame_lag=[0.9])
    lag = Piece(term("response_lag", "second"), np.array([1.7, 0.74, 1.0]))
    second = Choice(evaluate(ground, [lag]), (0, 0, 0), score)
    found = standing("frame_lag", frame, [frame, second], problem)
    assert ("response_lag" in found.alternatives) == said
    assert not found.tied


ALSO = [
    ("backlash", "tapered", [2.0, 0.6, 0.0, 55.0], "friction"),
    ("compliance", "driven", [0.4, 10.0, 1.0, 0.0], "slack"),
]


@pytest.mark.parametrize(("name", "form", "values", "also"), ALSO)
def test_what_another_name_tells_as_well_is_listed_and_ties(ground, name, form, values, also):
    piece = Piece(term(name, form), np.array(values))
    best = Choice(evaluate(ground, [piece]), (0, 0, 0), 0.0)
    found = standing(name, best, [best], ground.problem)
    assert also in found.alternatives
    assert found.tied


def test_dry_friction_at_what_a_wire_pulls_is_another_name_of_play_and_no_tie(ground):
    play = chosen(ground, 0.0, backlash=[2.0])
    found = standing("backlash", play, [play], ground.problem)
    assert found.alternatives[-1] == "friction"
    assert not found.tied
    coasting = Piece(term("backlash", "coasting"), np.array([2.0, 0.1, 0.0]))
    runs_on = Choice(evaluate(ground, [coasting]), (0, 0, 0), 0.0)
    told = standing("backlash", runs_on, [runs_on], ground.problem)
    assert "friction" not in told.alternatives


def test_what_touches_on_both_sides_may_as_well_be_soft(ground):
    lower = Piece(term("contact", "lower"), np.array([0.3, -20.0, 1.0]))
    upper = Piece(term("contact", "upper"), np.array([0.3, 20.0, 1.0]))
    for pieces, alternatives in (([lower], ()), ([lower, upper], ("compliance",))):
        best = Choice(evaluate(ground, pieces), (0, 0, 0), 0.0)
        found = standing("contact", best, [best], ground.problem)
        assert found.alternatives == alternatives
        assert found.tied == bool(alternatives)


@pytest.mark.parametrize(
    ("form", "values", "alternatives"),
    [
        ("upper", [0.3, 0.4, 1.0], ("compliance",)),
        ("upper", [0.3, 0.7, 0.1], ("compliance",)),
        ("upper", [0.3, 3.0, 1.0], ()),
        ("upper", [0.3, 3.0, 4.0], ()),
        ("upper unloading", [0.1, -2.6, 0.1, 0.5], ("compliance",)),
        ("lower unloading", [0.1, 2.6, 0.1, 0.5], ("compliance",)),
        ("upper unloading", [0.1, 3.0, 0.1, 0.5], ()),
        ("upper unloading", [0.1, -3.0, 0.1, 5.0], ()),
    ],
    ids=[
        "home",
        "home, sharply",
        "elsewhere",
        "gradually, elsewhere",
        "slack after home",
        "slack after home, below",
        "slack elsewhere",
        "slack far beyond",
    ],
)
def test_what_touches_at_home_may_be_the_softer_wire_on_the_other_side(
    ground, form, values, alternatives
):
    contact = Piece(term("contact", form), np.array(values))
    best = Choice(evaluate(ground, [contact]), (0, 0, 0), 0.0)
    found = standing("contact", best, [best], ground.problem)
    assert found.alternatives == alternatives
    assert found.tied == bool(alternatives)


@pytest.mark.parametrize(
    ("form", "values", "little"),
    [
        ("symmetric", [3.0, 0.5, 0.0], True),
        ("symmetric", [3.0, 2.0, 0.0], False),
        ("symmetric", [3.0, 0.5, 0.7], False),
        ("bristle", [3.0, 0.2, 1.0], True),
        ("bristle", [3.0, 2.0, 1.0], False),
        ("driven", [3.0, 2.0, 1.0], True),
        ("driven", [3.0, 4.0, 1.0], False),
        ("driven bank", [3.0, 1.0, 1.0], True),
        ("driven bank", [3.0, 9.0, 1.0], False),
    ],
)
def test_friction_that_gives_way_by_little_may_be_play(ground, form, values, little):
    best = Choice(evaluate(ground, [Piece(term("friction", form), np.array(values))]), (0, 0, 0), 0)
    alternatives = standing("friction", best, [best], ground.problem).alternatives
    assert ("backlash" in alternatives) == little


@pytest.mark.parametrize(
    ("form", "skin", "alternatives"),
    [("upper", 1.5, ("end_stop",)), ("lower", 1.5, ("end_stop",)), ("upper", 0.5, ())],
)
def test_how_stiff_a_contact_is_does_not_show_at_its_edge(ground, form, skin, alternatives):
    around = ground.problem.around
    end = around.angle_low + (around.angle_span if form == "upper" else 0.0)
    values = np.array([0.5, end - 3.0 * (1.0 if form == "upper" else -1.0), skin])
    best = Choice(evaluate(ground, [Piece(term("contact", form), values)]), (0, 0, 0), 0.0)
    assert standing("contact", best, [best], ground.problem).alternatives == alternatives


def test_a_stop_that_a_single_position_goes_beyond_may_be_a_contact():
    """A contact met between the last two positions, in noise that remembers."""
    up, rng = np.arange(-10.8, 10.81, 0.4), np.random.default_rng(0)
    drive = np.tile(np.concatenate([up, up[-1:], up[::-1], up[:1]]), 8)
    angle = up[-1] - 0.6 * 0.4
    seen = np.where(drive > angle, angle + 0.28 * (drive - angle), drive)
    fresh = 0.019 * np.sqrt(1.0 - 0.75**2) * rng.standard_normal(len(drive))
    noise = np.zeros(len(drive))
    for k in range(1, len(drive)):
        noise[k] = 0.75 * noise[k - 1] + fresh[k]
    time_s = 0.1 * np.arange(1, len(drive) + 1)
    result = diagnosed(followed(time_s, drive, seen + noise, 8 * 10.0 / len(drive)))
    assert names(result) == {"end_stop"}
    assert result.diagnoses[0].physics[0].alternatives == ("contact",)
    assert result.diagnoses[0].verdict == "ambiguous"

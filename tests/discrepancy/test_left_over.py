"""What a structured rest does to calibration and names that stand beside it."""

import numpy as np
import pytest

from pipeline.discrepancy.fitting.fit import evaluate, improve
from pipeline.discrepancy.fitting.ground import ground_of
from pipeline.discrepancy.judgement.rest import CYCLE
from pipeline.discrepancy.judgement.structure import RINGS, Structure
from pipeline.discrepancy.judgement.verdict import (
    PLAINLY,
    PLAINLY_OF_PILE,
    asked_of,
    fewer,
    plainly_told,
    weightier,
)
from pipeline.discrepancy.noise.noise import NoiseModel
from pipeline.discrepancy.search.accuracy import evenly_calibrated
from pipeline.discrepancy.search.weighing import Choice, names
from pipeline.physics.catalogue import term
from pipeline.physics.piece import Piece
from tests.discrepancy.made import ANGLE, NOISE, changed, explanation_of, posed, recorded

PLAY = Piece(term("backlash"), np.array([4.0]))
RIPPLE = Piece(term("transmission_ripple"), np.array([0.2, 30.0, 0.5]))
DRIFT = Piece(term("drift", "linear"), np.array([0.02]))


def left_by(choice: Choice) -> float:
    ground = choice.fit.ground
    off = (ground.problem.measured - choice.fit.predicted)[ground.used]
    return float(np.sqrt(np.mean(off**2)))


def test_where_all_is_structured_calibration_is_no_matter_of_where_a_walk_began():
    plain = recorded({}, offset=0.0)
    bump = 3.0 * np.sin(np.linspace(0.0, np.pi, len(plain.samples))) ** 2
    problem = posed(changed(plain, **{ANGLE: plain.samples[ANGLE] + bump}))
    walks = ground_of(problem, NoiseModel(white=NOISE, walk=NOISE), problem.train)
    walked = Choice(evaluate(walks, ()), (0, 0, 7), 0.0)
    even = evenly_calibrated(walked, walks.used)
    assert left_by(even) < 0.8 * left_by(walked)
    assert left_by(even) == pytest.approx(float(np.std(bump[problem.train])), rel=0.1)
    assert even.fit.ground.noise == walks.noise


@pytest.mark.parametrize(("structured", "stay"), [(np.inf, set()), (1e-4, {RIPPLE.term.name})])
def test_beside_a_small_rest_what_explains_more_than_that_keeps_its_name(structured, stay):
    hidden = {"backlash": {"width": 4.0}, "transmission_ripple": {"amplitude": 0.2, "period": 30.0,
              "phase": 0.5}, "drift/linear": {"rate": 0.02}}  # fmt: skip
    problem = posed(recorded(hidden))
    ground = ground_of(problem, NoiseModel(NOISE), problem.train)
    choice = Choice(evaluate(ground, (PLAY, RIPPLE, DRIFT)), (0, 0, 0), 0.0)
    explanation = explanation_of([choice])
    assert names(weightier(explanation, choice, structured)) == {PLAY.term.name, *stay}


@pytest.mark.parametrize(("size", "stay"), [(0.4, True), (4.0, False)])
def test_beside_a_rest_several_names_stay_that_each_explain_many_times_as_much(size, stay):
    hidden = {"backlash": {"width": 4.0}, "transmission_ripple": {"amplitude": 4.0, "period": 30.0,
              "phase": 0.5}}  # fmt: skip
    plain = recorded(hidden)
    swing = size * np.sin(np.linspace(0.0, 21.0, len(plain.samples)))
    problem = posed(changed(plain, **{ANGLE: plain.samples[ANGLE] + swing}))
    ground = ground_of(problem, NoiseModel(NOISE), problem.train)
    ripple = Piece(RIPPLE.term, np.array([4.0, 30.0, 0.5]))
    choice = Choice(evaluate(ground, (PLAY, ripple)), (0, 0, 0), 0.0)
    told = names(plainly_told(explanation_of([choice]), choice, NOISE**2, PLAINLY))
    assert told == ({"backlash", "transmission_ripple"} if stay else set())


@pytest.mark.parametrize(("height", "stay"), [(0.5, True), (8.0, False)])
def test_beside_what_has_no_name_only_names_stay_that_explain_many_times_as_much(height, stay):
    hidden = {"backlash": {"width": 4.0},
              "friction/snapping": {"height": height, "middle": 2.0, "apart": 20.0}}  # fmt: skip
    problem = posed(recorded(hidden))
    ground = ground_of(problem, NoiseModel(NOISE), problem.train)
    snap = Piece(term("friction", "snapping"), np.array([height, 2.0, 20.0, 5.0]))
    choice = Choice(improve(evaluate(ground, (PLAY, snap))), (0, 0, 0), 0.0)
    told = plainly_told(explanation_of([choice]), choice, NOISE**2, PLAINLY)
    assert ("backlash" in names(told)) == stay


@pytest.mark.parametrize(
    ("where", "share", "stay"),
    [
        (CYCLE, 0.05, {"backlash"}),
        (CYCLE, 1e-4, {"backlash", "transmission_ripple"}),
        (RINGS, 1e-4, {"backlash"}),
        ("time", 1e-4, {"backlash", "transmission_ripple"}),
    ],
)
def test_beside_what_changes_from_cycle_to_cycle_by_much_or_rings_stays_one_name(
    where, share, stay
):
    ripple = {"amplitude": 1.0, "period": 30.0, "phase": 0.5}
    problem = posed(recorded({"backlash": {"width": 8.0}, "transmission_ripple": ripple}))
    ground = ground_of(problem, NoiseModel(NOISE), problem.train)
    play, wave = (
        Piece(p.term, np.array(v)) for p, v in ((PLAY, [8.0]), (RIPPLE, [1.0, 30.0, 0.5]))
    )
    base, both = (Choice(evaluate(ground, p), (0, 0, 0), 0.0) for p in ((), (play, wave)))
    explanation = explanation_of([both, base])
    structure = Structure(True, where, share, 1e-6)
    assert names(fewer(explanation, both, structure)) == stay


@pytest.mark.parametrize(
    ("size", "count", "asked"),
    [(0.1, 4, PLAINLY), (1.0, 4, PLAINLY_OF_PILE), (1.0, 3, PLAINLY)],
)
def test_more_is_asked_of_a_pile_of_names_that_leaves_more_than_the_noise(size, count, asked):
    hidden = {"backlash": {"width": 4.0}, "transmission_ripple": {"amplitude": 0.2, "period": 30.0,
              "phase": 0.5}, "drift/linear": {"rate": 0.02}}  # fmt: skip
    plain = recorded(hidden)
    swing = size * np.sin(np.linspace(0.0, 21.0, len(plain.samples)))
    problem = posed(changed(plain, **{ANGLE: plain.samples[ANGLE] + swing}))
    ground = ground_of(problem, NoiseModel(NOISE), problem.train)
    creep = Piece(term("creep"), np.array([1e-3, 9.0]))
    choice = Choice(evaluate(ground, (PLAY, RIPPLE, DRIFT, creep)[:count]), (0, 0, 0), 0.0)
    assert asked_of(explanation_of([choice]), choice, NOISE**2) == asked

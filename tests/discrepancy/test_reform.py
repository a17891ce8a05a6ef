"""Forms of a term that hold more than the one that was found."""

from dataclasses import replace

import numpy as np
import pytest

from pipeline.discrepancy.fitting.fit import evaluate, improve
from pipeline.discrepancy.fitting.ground import ground_of
from pipeline.discrepancy.fitting.reform import reformed
from pipeline.discrepancy.noise.noise import NoiseModel
from pipeline.discrepancy.search import growth
from pipeline.discrepancy.search.weighing import Choice, Search
from pipeline.physics.catalogue import richer, term
from pipeline.physics.piece import Piece
from tests.discrepancy.made import explanation_of, posed, recorded

QUIET = 0.05


def ground_with(hidden):
    recording = recorded(hidden, noise=QUIET)
    problem = posed(recording)
    return ground_of(problem, NoiseModel(QUIET, 0.0, 0.0), problem.train)


@pytest.mark.parametrize("apart", [(0.083, 6.7, 0.05, 34.0), (0.12, 7.0, 0.08, 60.0)])
def test_creep_of_two_times_is_found_from_the_one_between_them(apart):
    names = ("share", "time_constant", "share_2", "time_constant_2")
    hidden = dict(zip(names, apart, strict=True))
    ground = ground_with({"creep/two": hidden})
    truth = improve(evaluate(ground, [Piece(term("creep", "two"), np.array(apart))]), 10)
    between = improve(evaluate(ground, [Piece(term("creep", "one"), np.array([0.1, 25.0]))]), 20)
    assert between.cost > truth.cost + 30.0
    assert reformed(between, 0, term("creep", "two")).cost < truth.cost + 1.0


@pytest.mark.parametrize(("growth", "settled"), [(0.006, 180.0), (0.004, 150.0)])
def test_play_that_has_settled_soon_is_found_from_one_that_grows_little(growth, settled):
    ground = ground_with(
        {"tension_loss/settling": {"growth": growth, "width": 0.0, "settled": settled}}
    )
    course = term("tension_loss", "settling")
    truth = improve(evaluate(ground, [Piece(course, np.array([growth, 0.0, settled]))]), 10)
    steady = Piece(term("tension_loss", "linear"), np.array([1e-4, 0.6]))
    begun = improve(evaluate(ground, [steady]), 20)
    assert begun.cost > truth.cost + 30.0
    assert reformed(begun, 0, course).cost < truth.cost + 3.0


@pytest.mark.parametrize(
    ("form", "course"), [("late", [0.005, 0.3, 400.0]), ("settling", [0.006, 0.0, 180.0])]
)
def test_a_course_of_the_travel_is_found_from_play_that_grows_by_cycle(form, course):
    own = term("tension_loss", form)
    names = ("growth", "width", "onset" if form == "late" else "settled")
    ground = ground_with({f"tension_loss/{form}": dict(zip(names, course, strict=True))})
    truth = improve(evaluate(ground, [Piece(own, np.array(course))]), 10)
    by_cycle = Piece(term("tension_loss", "cycle"), np.array([0.5, 0.2]))
    begun = improve(evaluate(ground, [by_cycle]), 20)
    assert begun.cost > truth.cost + 30.0
    further = {t.form: t for t in richer(by_cycle.term)}
    assert reformed(begun, 0, further[form]).cost < truth.cost + 3.0


@pytest.mark.parametrize("ratio", [2.3, 3.6])
@pytest.mark.parametrize(("form", "size"), [("first", 3), ("second afloat", 5)])
def test_a_wave_of_another_period_is_found_beside_one(ratio, form, size):
    waves = {"amplitude": 2.0, "period": 40.0, "phase": 1.0,
             "other_amplitude": 1.2, "other_period": 40.0 / ratio, "other_phase": 3.0}  # fmt: skip
    ground = ground_with({"transmission_ripple/two afloat": waves})
    two = term("transmission_ripple", "two afloat")
    truth = improve(evaluate(ground, [Piece(two, np.array([*waves.values()]))]), 10)
    alone = Piece(term("transmission_ripple", form), np.array([1.8, 38.0, 1.1, 0.1, 0.0][:size]))
    begun = improve(evaluate(ground, [alone]), 20)
    assert begun.cost > truth.cost + 30.0
    assert reformed(begun, 0, two).cost < truth.cost + 1.0


def test_edges_that_come_less_than_three_times_are_no_teeth():
    long = {"amplitude": 2.0, "period": 48.0, "phase": 1.0, "amplitude_3": 0.6, "phase_3": 3.0}
    ground = ground_with({"transmission_ripple/third afloat": long})
    waves = Piece(term("transmission_ripple", "third afloat"), np.array([*long.values()]))
    toothed = reformed(evaluate(ground, [waves]), 0, term("transmission_ripple", "odd afloat"))
    assert toothed.pieces[0].values[1] <= ground.problem.around.drive_span / 3.0


@pytest.mark.parametrize(("better", "takes"), [(1e-6, False), (0.01, True)])
def test_a_form_that_is_better_by_rounding_takes_no_place(better, takes, monkeypatch):
    """As what another axis drives directly or through a curve that is straight."""
    ground = ground_with({"backlash": {"width": 2.0}})
    plain = Choice(evaluate(ground, [Piece(term("backlash"), np.array([2.0]))]), (0, 0, 0), 0.0)
    search = explanation_of([plain]).search
    other = evaluate(ground, [Piece(term("backlash", "pin"), np.array([1.4]))])
    alike = replace(other, cost=plain.fit.cost - better)
    monkeypatch.setattr(growth, "reformed", lambda *_: alike)
    monkeypatch.setattr(Search, "weighed", lambda _, fit, place: Choice(fit, place, -better))
    assert (growth.grown(search, plain).fit is alike) == takes

"""Names that explain less than what the form of others leaves."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from pipeline.discrepancy.fitting.fit import evaluate, improve
from pipeline.discrepancy.judgement.faint import charged, without_faint
from pipeline.discrepancy.search.explain import Explanation
from pipeline.discrepancy.search.weighing import LEAST_GAIN
from pipeline.physics.catalogue import term
from pipeline.physics.piece import Piece
from pipeline.physics.term import Term
from tests.discrepancy.made import explained, recorded

RIPPLE = term("transmission_ripple")
Named = dict[str, float]


def beside(own: Term, values: Named, others: Mapping[str, Named], cycles: int = 6) -> Explanation:
    """An explanation whose best choice has a term beside the others, as if it were worth it."""
    recording = recorded({**others, f"{own.name}/{own.form}": values}, cycles=cycles, seed=1)
    found = explained(recording)
    best = next(c for c in found.choices if set(c.fit.names) >= set(others))
    kept = [p for p in best.fit.pieces if p.term.name in others]
    piece = Piece(own, np.array(list(values.values())))
    fit = improve(evaluate(best.fit.ground, [*kept, piece]))
    return replace(found, choices=[replace(best, fit=fit, score=-1e6), *found.choices])


def rippled(amplitude: float, **others: Named) -> Explanation:
    return beside(RIPPLE, {"amplitude": amplitude, "period": 30.0, "phase": 1.0}, others)


@pytest.mark.parametrize(("amplitude", "stays"), [(0.05, False), (0.3, True)])
def test_a_faint_name_beside_two_others_is_their_form(amplitude: float, stays: bool):
    found = rippled(amplitude, backlash={"width": 3.0}, end_stop={"angle": 30.0})
    firm = without_faint(found)
    assert (firm is found) == stays
    assert set(firm.choices[0].fit.names) >= {"backlash", "end_stop"}
    assert (RIPPLE.name in firm.choices[0].fit.names) == stays


@pytest.mark.parametrize(("amplitude", "stays"), [(0.05, False), (0.1, True)])
def test_a_faint_name_that_is_one_of_two_stands_by_what_it_earns(amplitude: float, stays: bool):
    found = rippled(amplitude, backlash={"width": 3.0})
    firm = without_faint(found)
    assert (firm is found) == stays
    assert "backlash" in firm.choices[0].fit.names
    assert (RIPPLE.name in firm.choices[0].fit.names) == stays


@pytest.mark.parametrize(("amplitude", "stays"), [(0.06, False), (0.1, True)])
@pytest.mark.long
def test_many_samples_that_make_a_faint_name_sure_make_it_no_physics(amplitude: float, stays: bool):
    values = {"amplitude": amplitude, "period": 30.0, "phase": 1.0}
    found = beside(RIPPLE, values, {"backlash": {"width": 3.0}}, cycles=24)
    assert (without_faint(found) is found) == stays


@pytest.mark.parametrize(("lag", "stays"), [(0.01, False), (0.05, True)])
def test_what_comes_hardly_late_beside_one_other_name_is_its_form(lag: float, stays: bool):
    found = beside(term("frame_lag", "frames"), {"lag": lag}, {"end_stop": {"angle": 30.0}})
    assert (without_faint(found) is found) == stays


def test_each_name_that_others_have_more_of_has_to_earn_what_a_search_asks():
    found = rippled(0.05, backlash={"width": 3.0}, end_stop={"angle": 30.0})
    piled, firm = found.choices[0], without_faint(found).choices[0]
    assert charged(piled, firm).score == piled.score + LEAST_GAIN
    assert charged(firm, piled) == firm
    assert charged(piled, piled) == piled

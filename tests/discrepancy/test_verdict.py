"""Which names a verdict bears: a zero that wanders may be a drift, or noise."""

from dataclasses import replace

import numpy as np
import pytest

from pipeline.discrepancy.fitting.fit import evaluate, improve
from pipeline.discrepancy.judgement.structure import Structure
from pipeline.discrepancy.judgement.verdict import (
    earning,
    least_lead,
    sure_of_slow,
    told_but_for_its_form,
    unless_nothing,
)
from pipeline.discrepancy.noise.family import Place
from pipeline.discrepancy.search.explain import Explanation
from pipeline.discrepancy.search.weighing import Choice, names
from pipeline.physics.catalogue import term
from pipeline.physics.piece import Piece
from tests.discrepancy.made import explained, explanation_of, recorded

DRIFT = Piece(term("drift", "linear"), np.array([0.3]))
PLAY = Piece(term("backlash"), np.array([4.0]))
STILL, WALKS, JITTERS = (0, 0, 0), (0, 0, 3), (0, 4, 0)
WALKS_FAR, LEAPS = (0, 0, 4), (0, 5, 0)


@pytest.fixture(scope="module")
def found() -> Explanation:
    return explained(recorded({"backlash": {"width": 4.0}}))


@pytest.fixture(scope="module")
def calm() -> Explanation:
    return explained(recorded({}))


def chosen(found: Explanation, *weighed: tuple[tuple[Piece, ...], Place, float]) -> frozenset[str]:
    """The names that stay of choices: their pieces, where their noise lies, and their scores."""
    ground = found.choices[0].fit.ground
    choices = [Choice(evaluate(ground, pieces), place, score) for pieces, place, score in weighed]
    choices.sort(key=lambda c: c.score)
    return names(sure_of_slow(replace(found, choices=choices), choices[0]))


@pytest.mark.parametrize(
    ("place", "behind", "named"),
    [
        (WALKS, 2.0, True),
        (WALKS, 3.5, False),
        (WALKS_FAR, 6.0, True),
        (LEAPS, 6.0, True),
        (LEAPS, 8.0, False),
    ],
)
def test_beside_other_names_a_restless_zero_is_told_as_the_drift_that_fits_as_well(
    found: Explanation, place: Place, behind: float, named: bool
) -> None:
    jitters = ((PLAY, DRIFT), JITTERS, behind)
    assert ("drift" in chosen(found, ((PLAY,), place, 0.0), jitters)) == named


@pytest.mark.parametrize(("better", "named"), [(3.0, set()), (4.0, set()), (5.0, {"backlash"})])
def test_a_name_alone_is_told_at_odds_of_ten_to_one_against_none(
    calm: Explanation, better: float, named: set[str]
) -> None:
    ground = calm.choices[0].fit.ground
    best = Choice(evaluate(ground, (PLAY,)), STILL, -better)
    base = Choice(evaluate(ground, ()), STILL, 0.0)
    told = unless_nothing(replace(calm, choices=[best, base]), best)
    assert names(told) == named


@pytest.mark.parametrize(
    ("place", "behind", "named"),
    [(JITTERS, 3.0, False), (JITTERS, 6.0, True), (WALKS, 3.0, True), (LEAPS, 3.0, True)],
)
def test_a_drift_beside_other_names_must_fit_clearly_better_than_a_usual_jitter(
    found: Explanation, place: Place, behind: float, named: bool
) -> None:
    slow = ((PLAY, DRIFT), STILL, 0.0)
    assert ("drift" in chosen(found, slow, ((PLAY,), place, behind))) == named


def test_a_drift_is_not_told_in_place_of_other_noise(found: Explanation) -> None:
    assert chosen(found, ((PLAY,), JITTERS, 0.0), ((PLAY, DRIFT), STILL, 1.0)) == {"backlash"}
    assert chosen(found, ((PLAY,), LEAPS, 0.0), ((PLAY, DRIFT), LEAPS, 1.0)) == {"backlash"}


@pytest.mark.parametrize(
    ("far", "repeats", "ahead", "named"),
    [
        (False, 3, -1.0, False),
        (False, 3, 1.0, True),
        (False, 0, 15.0, False),
        (False, 0, 16.0, True),
        (True, 0, 55.0, False),
        (True, 0, 56.0, True),
    ],
)
def test_by_itself_a_drift_needs_odds_against_noise_that_walks(
    found: Explanation, calm: Explanation, far: bool, repeats: int, ahead: float, named: bool
) -> None:
    """Where nothing repeats, a search charges a walk 11 more than elsewhere.

    It charges 40 more for one that takes more than the noise, as that of a hidden play.
    """
    told = found if far else calm
    prior = replace(told.prior, repeats=repeats)
    search = replace(told.search, family=replace(told.search.family, prior=prior))
    judged = replace(told, prior=prior, search=search)
    kept = chosen(judged, ((DRIFT,), STILL, 0.0), ((), WALKS, ahead))
    assert kept == ({"drift"} if named else frozenset())


@pytest.mark.parametrize(("share", "told"), [(0.002, False), (0.003, True)])
def test_a_rest_of_a_twentieth_of_the_mismatch_is_the_form_of_what_was_named(
    found: Explanation, share: float, told: bool
) -> None:
    rest = Structure(True, "the cycle", share, 1e-9)
    kept = told_but_for_its_form(found, found.choices[0], rest)
    assert (kept.found, kept.where, kept.share) == (told, "the cycle", share)
    nothing = next(c for c in found.choices if not c.fit.pieces)
    assert told_but_for_its_form(found, nothing, rest) == rest


def test_what_a_wrong_gain_explains_makes_no_rest_a_form() -> None:
    off = explained(recorded({"backlash": {"width": 4.0}}, gain=1.2))
    rest = Structure(True, "the cycle", 5e-4, 1e-9)
    assert told_but_for_its_form(off, off.choices[0], rest).found


@pytest.mark.parametrize(
    ("repeats", "place", "pieces", "odds"),
    [
        (4, WALKS, (DRIFT,), 1.0),
        (0, WALKS, (DRIFT,), 10.0),
        (0, WALKS_FAR, (DRIFT,), 3.0),
        (0, WALKS_FAR, (DRIFT, PLAY), 10.0),
        (4, JITTERS, (DRIFT,), 10.0),
    ],
)
def test_a_drift_alone_is_told_in_place_of_a_walk_at_lower_odds_than_other_names(
    calm: Explanation, repeats: int, place: Place, pieces: tuple[Piece, ...], odds: float
) -> None:
    ground = calm.choices[0].fit.ground
    drift = Choice(evaluate(ground, pieces), STILL, 0.0)
    walk = Choice(evaluate(ground, []), place, 0.0)
    lead = least_lead(explanation_of([drift, walk], repeats=repeats), drift, walk)
    assert lead == pytest.approx(2.0 * np.log(odds))


@pytest.mark.parametrize(("over_ripple", "kept"), [(0.4, True), (0.6, False), (90.0, False)])
def test_beside_a_rest_a_name_has_to_explain_twice_of_it_but_the_last_one_stays(
    over_ripple: float, kept: bool
) -> None:
    """over_ripple: the mean square of the rest over what the ripple explains."""
    ripple = {"amplitude": 0.6, "period": 30.0, "phase": 1.0}
    beside = explained(
        recorded({"backlash": {"width": 4.0}, "transmission_ripple": ripple}, noise=0.02)
    )
    wave = Piece(term("transmission_ripple"), np.array(list(ripple.values())))
    ground = beside.choices[0].fit.ground
    both = Choice(improve(evaluate(ground, (PLAY, wave))), STILL, 0.0)
    alone = improve(evaluate(ground, (both.fit.pieces[0],)))
    explains = alone.mean_square - both.fit.mean_square
    told = names(earning(beside, both, over_ripple * explains))
    assert "backlash" in told
    assert ("transmission_ripple" in told) == kept

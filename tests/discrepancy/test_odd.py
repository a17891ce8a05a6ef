"""What is tried last: it has to be worth much where it only comes besides."""

from dataclasses import replace

import numpy as np
import pytest

from pipeline.discrepancy.fitting.fit import Fit, evaluate
from pipeline.discrepancy.search import odd
from pipeline.discrepancy.search.explain import Explanation
from pipeline.discrepancy.search.odd import FIRM, may_mop_up, oddly
from pipeline.discrepancy.search.weighing import Choice
from pipeline.physics.catalogue import term
from pipeline.physics.piece import Piece
from tests.discrepancy.made import explained, recorded

PLAY = Piece(term("backlash"), np.array([4.0]))
TILT = Piece(term("camera_tilt"), np.array([0.3, 0.0]))
DRIFT = Piece(term("drift", "linear"), np.array([0.3]))
BUMP = Piece(term("transmission_ripple", "bump"), np.array([0.5, 10.0, 4.0]))


@pytest.fixture(scope="module")
def found() -> Explanation:
    return explained(recorded({"backlash": {"width": 4.0}}))


@pytest.mark.parametrize(
    ("pieces", "gain", "mops_up"),
    [
        ([PLAY, TILT, BUMP], 0.5 * FIRM, True),
        ([PLAY, TILT, BUMP], 2.0 * FIRM, False),
        ([PLAY, BUMP], 0.5 * FIRM, False),
        ([PLAY, TILT, DRIFT], 0.5 * FIRM, False),
    ],
)
def test_what_comes_besides_as_many_names_must_be_worth_much(
    found: Explanation, pieces: list[Piece], gain: float, mops_up: bool
) -> None:
    ground = found.choices[0].fit.ground
    best = Choice(evaluate(ground, [PLAY, TILT]), (0, 0, 0), 0.0)
    assert may_mop_up(Choice(evaluate(ground, pieces), (0, 0, 0), -gain), best) == mops_up


def test_what_was_tried_last_and_put_aside_is_not_remembered() -> None:
    bent = explained(recorded({"gravity": {"deflection": 6.0, "zero": 0.7}}))
    search = replace(bent.search, seen={})
    oddly(search, bent.choices)
    assert search.seen == {}


@pytest.mark.parametrize(("left_over", "fewest_gone"), [(False, 2), (True, 0)])
def test_where_repeats_leave_nothing_what_is_seldom_only_stands_for_two(
    found: Explanation, monkeypatch: pytest.MonkeyPatch, left_over: bool, fewest_gone: int
) -> None:
    tried: list[int] = []

    def screened(fit: Fit, *_: object, **__: object) -> list[object]:
        tried.append(len(fit.pieces))
        return []

    monkeypatch.setattr(odd, "screen", screened)
    monkeypatch.setattr(odd, "not_noise", lambda *_: left_over)
    assert found.search.family.prior.repeats > 0
    ground = found.choices[0].fit.ground
    for pieces in ([], [PLAY], [PLAY, TILT], [PLAY, TILT, DRIFT]):
        tried.clear()
        oddly(found.search, [Choice(evaluate(ground, pieces), (0, 0, 0), 0.0)])
        assert max(tried) == max(min(len(pieces) - fewest_gone, 2), 0)

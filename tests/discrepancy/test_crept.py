"""Slow creep at an even pace: a lag, but for the first cycle."""

import numpy as np
import pytest

from pipeline.discrepancy.fitting.fit import evaluate, improve
from pipeline.discrepancy.search.crept import crept
from pipeline.discrepancy.search.explain import Explanation
from pipeline.discrepancy.search.weighing import Choice
from pipeline.physics.catalogue import term
from pipeline.physics.piece import Piece
from tests.discrepancy.made import AMPLITUDE, STEPS, explained, followed

WAIT_S, NOISE, SHARE, LATE_S = 3.36, 0.1, 0.12, 200.0


@pytest.fixture(scope="module")
def creeping() -> Explanation:
    rows = np.arange(6 * STEPS)
    drive = AMPLITUDE * np.sin(2.0 * np.pi * (rows + 1.0) / STEPS)
    late, at = np.zeros(len(rows)), 0.0
    for k, there in enumerate(drive):
        late[k] = at = there + (at - there) * np.exp(-WAIT_S / LATE_S)
    seen = (1.0 - SHARE) * drive + SHARE * late
    seen += NOISE * np.random.default_rng(5).standard_normal(len(rows))
    return explained(followed(WAIT_S * rows, drive, seen, 1.0 / (WAIT_S * STEPS)))


def with_pieces(explanation: Explanation, **pieces: list[float]) -> Choice:
    ground = explanation.choices[0].fit.ground
    fit = evaluate(ground, [Piece(term(n), np.array(v)) for n, v in pieces.items()])
    return explanation.search.weighed(improve(fit), (0, 0, 0))


def test_creep_takes_the_place_of_a_lag_and_an_early_slip(creeping):
    lag = with_pieces(creeping, response_lag=[4.0], lost_steps=[-0.3, 300.0])
    found = crept(creeping.search, lag)
    assert found.fit.names == ("creep",)
    assert found.score < lag.score - 20.0
    assert found.fit.values[1] == pytest.approx(LATE_S, rel=0.3)


def test_a_lag_alone_stays(creeping):
    lag = with_pieces(creeping, response_lag=[4.0])
    assert crept(creeping.search, lag) is lag

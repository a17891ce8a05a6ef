"""The small compiled systems of a fit against plain linear algebra."""

import numpy as np
import pytest

from pipeline.discrepancy.fitting.normal import added, regressed, solved, stepped
from pipeline.discrepancy.noise.noise import NoiseModel, likelihood_of, square_of, whitened

ROWS = 300
RNG = np.random.default_rng(4)
CYCLE = np.repeat(np.arange(3), ROWS // 3)
USED = RNG.random(ROWS) > 0.2
STANDS = np.zeros(ROWS, dtype=bool)
NOISE = NoiseModel(0.7, 0.5, 0.6, jitter=0.3, walk=0.05)


def dense() -> np.ndarray:
    """Covariance of the noise on the used rows."""
    rows = np.arange(ROWS)
    apart = np.abs(rows[:, None] - rows)
    out = NOISE.white**2 * np.eye(ROWS) + NOISE.correlated**2 * NOISE.correlation**apart
    out += NOISE.jitter**2 * (CYCLE[:, None] == CYCLE)
    out += NOISE.walk**2 * np.minimum(rows[:, None], rows)
    return out[np.ix_(USED, USED)]


def test_a_definite_system_is_solved_as_numpy_solves_it():
    root = RNG.normal(size=(6, 6))
    normal, right = root @ root.T + np.eye(6), RNG.normal(size=(6, 3))
    assert solved(normal, right) == pytest.approx(np.linalg.solve(normal, right), rel=1e-9)


def test_columns_that_are_alike_are_solved_without_a_failure():
    normal = np.ones((2, 2))
    x = solved(normal, np.ones((2, 1)))
    assert normal @ x == pytest.approx(np.ones((2, 1)), rel=1e-6)


@pytest.mark.parametrize("many", [0, 1, 2, 3, 5])
def test_however_many_columns_there_are_each_is_whitened_as_by_itself(many):
    columns = RNG.normal(size=(ROWS, many))
    kalman = NOISE.gains(CYCLE, USED, STANDS), NOISE.kept(STANDS), CYCLE
    white = whitened(columns, *kalman)
    root = np.linalg.cholesky(dense())
    np.testing.assert_allclose(white, np.linalg.solve(root, columns[USED]), atol=1e-9)


def test_weights_and_cost_are_those_of_generalised_least_squares():
    columns, measured = RNG.normal(size=(ROWS, 3)), RNG.normal(size=ROWS)
    precision, expected = np.diag([4.0, 0.5, 1.0]), np.array([1.0, 0.0, -0.2])
    kalman = NOISE.gains(CYCLE, USED, STANDS), NOISE.kept(STANDS), CYCLE
    data = whitened(measured[:, None], *kalman)[:, 0]
    weights, innovations, white, cost = regressed(columns, data, kalman, precision, expected)
    inverse = np.linalg.inv(dense())
    own, y = columns[USED], measured[USED]
    normal = own.T @ inverse @ own + precision
    right = own.T @ inverse @ y + precision @ expected
    assert weights == pytest.approx(np.linalg.solve(normal, right), rel=1e-7)
    left, off = y - own @ weights, weights - expected
    assert cost == pytest.approx(left @ inverse @ left + off @ precision @ off, rel=1e-9)
    assert innovations == pytest.approx(data - white @ weights, abs=1e-12)


def test_likelihood_and_squares_are_those_of_the_whole_covariance():
    residual = np.where(USED, RNG.normal(size=ROWS), 0.0)
    sizes = NOISE.white, NOISE.correlated, NOISE.kept(STANDS), NOISE.jitter, NOISE.walk
    square, logs = likelihood_of(residual, *sizes, CYCLE, USED)
    covariance, own = dense(), residual[USED]
    assert square == pytest.approx(own @ np.linalg.solve(covariance, own), rel=1e-9)
    assert logs == pytest.approx(np.linalg.slogdet(covariance)[1], rel=1e-9)
    gains, level = NOISE.gains(CYCLE, USED, STANDS), RNG.normal(size=len(own))
    same, along = square_of(residual, gains, NOISE.kept(STANDS), CYCLE, level)
    white = whitened(residual[:, None], gains, NOISE.kept(STANDS), CYCLE)[:, 0]
    assert same == pytest.approx(square, rel=1e-9)
    assert along == pytest.approx(level @ white, rel=1e-9)


def test_a_step_stays_within_bounds_and_foretells_what_it_gains():
    normal = np.array([[4.0, 1.0, 0.0], [1.0, 3.0, 0.0], [0.0, 0.0, 1e-20]])
    values, gradient = np.array([0.0, 1.0, 0.5]), np.array([-1.0, 2.0, 1.0])
    moved, foretold = stepped(values, normal, gradient, np.zeros(3), np.full(3, 1.5), 0.01)
    assert moved == pytest.approx([0.0, 1.5, 0.5])  # against a bound, cut at one, moves nothing
    assert foretold == pytest.approx(2.0 * 2.0 * 0.5 - 3.0 * 0.25)


def test_a_product_is_added_to_a_copy():
    columns = RNG.normal(size=(5, 2))
    before = columns.copy()
    sum_of_both = added(columns, np.arange(5.0), np.array([2.0, -1.0]))
    assert sum_of_both == pytest.approx(before + np.outer(np.arange(5.0), [2.0, -1.0]))
    assert np.array_equal(columns, before)

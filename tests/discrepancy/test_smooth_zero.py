"""The likelihood of a zero that wanders smoothly, against that of its covariance as a whole."""

import numpy as np
import pytest

from pipeline.discrepancy.noise.smooth_zero import SmoothZero, likeliest_zero

ZERO = SmoothZero(white=0.2, fast=0.15, correlation=0.6, zero=1.3, pace=0.05)
ROWS = 300
USED = np.arange(ROWS) % 7 > 0
CARRIER = np.sin(np.arange(ROWS) / 20.0)


def covariance(model: SmoothZero, carrier: np.ndarray) -> np.ndarray:
    apart = np.abs(np.subtract.outer(np.arange(ROWS), np.arange(ROWS)))
    zero = model.zero**2 * (1.0 + model.pace * apart) * np.exp(-model.pace * apart)
    fast = model.fast**2 * model.correlation**apart
    return model.white**2 * np.eye(ROWS) + fast + np.outer(carrier, carrier) * zero


def drawn(model: SmoothZero, carrier: np.ndarray, seed: int) -> np.ndarray:
    root = np.linalg.cholesky(covariance(model, carrier))
    return root @ np.random.default_rng(seed).standard_normal(ROWS)


@pytest.mark.parametrize("carrier", [np.ones(ROWS), CARRIER], ids=["zero", "carried"])
def test_it_is_that_of_a_gaussian_with_the_matern_covariance(carrier):
    residual = drawn(ZERO, carrier, 1)
    whole = covariance(ZERO, carrier)[np.ix_(USED, USED)]
    _, log_determinant = np.linalg.slogdet(whole)
    square = residual[USED] @ np.linalg.solve(whole, residual[USED])
    found = ZERO.log_likelihood(np.where(USED, residual, 0.0), carrier, USED)
    assert found == pytest.approx(-0.5 * (square + log_determinant), rel=1e-9)


def test_columns_are_whitened_alike():
    residual = np.where(USED, drawn(ZERO, np.ones(ROWS), 2), 0.0)
    columns = np.column_stack([residual, CARRIER, 2.0 * residual])
    white, _ = ZERO.innovations(columns, np.ones(ROWS), USED)
    alone, _ = ZERO.innovations(residual[:, None], np.ones(ROWS), USED)
    assert white[:, [0]] == pytest.approx(alone)
    assert white[:, 2] == pytest.approx(2.0 * white[:, 0])


def test_the_likeliest_is_about_the_one_drawn():
    steady = np.ones(ROWS)
    zeros = [likeliest_zero(drawn(ZERO, steady, seed), steady, USED)[1] for seed in range(8)]
    assert np.median([z.deviation for z in zeros]) == pytest.approx(ZERO.deviation, rel=0.15)
    assert np.median([z.pace for z in zeros]) == pytest.approx(ZERO.pace, rel=0.4)


def test_what_it_begins_from_may_be_better_but_never_worse():
    residual = drawn(ZERO, CARRIER, 3)
    alone, _ = likeliest_zero(residual, CARRIER, USED)
    helped, _ = likeliest_zero(residual, CARRIER, USED, (ZERO,))
    assert helped >= alone
    assert helped >= ZERO.log_likelihood(np.where(USED, residual, 0.0), CARRIER, USED)

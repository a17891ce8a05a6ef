from pathlib import Path

import numpy as np
import pytest
from scipy.signal import lfilter

from pipeline.discrepancy.noise.serial import (
    SerialNoise,
    fit_serial_noise,
    lengths,
    orthonormal,
    without,
)

NOISE = SerialNoise(sigma=1.0, correlation=0.7, share=0.6)
ROW = np.array([0, 1, 2, 5, 6, 9, 10, 11])


def covariance(row: np.ndarray) -> np.ndarray:
    apart = np.abs(row[:, None] - row[None, :])
    return NOISE.share * NOISE.correlation**apart + (1.0 - NOISE.share) * np.eye(len(row))


def test_whitening_is_the_inverse_cholesky_factor_also_over_gaps() -> None:
    white = NOISE.whiten(np.eye(len(ROW)), ROW)
    assert white @ covariance(ROW) @ white.T == pytest.approx(np.eye(len(ROW)), abs=1e-12)


def test_expected_square_of_projected_noise_is_the_trace() -> None:
    columns = orthonormal(np.column_stack([np.ones(len(ROW)), ROW]))
    expected = np.trace(columns.T @ covariance(ROW) @ columns)
    assert NOISE.excess(columns, ROW) == pytest.approx(expected)


@pytest.mark.parametrize(("correlation", "share"), [(0.5, 1.0), (0.9, 1.0), (0.8, 0.5)])
def test_noise_is_recovered_beside_a_large_model(correlation: float, share: float) -> None:
    rng = np.random.default_rng(3)
    n = 1500
    model = np.cos(np.arange(n)[:, None] / n * np.pi * np.arange(1, 41))
    driven = rng.standard_normal(n + 400) * np.sqrt(1.0 - correlation**2)
    slow = lfilter([1.0], [1.0, -correlation], driven)[400:]
    noise = 0.3 * (np.sqrt(share) * slow + np.sqrt(1.0 - share) * rng.standard_normal(n))
    found = fit_serial_noise(noise + model @ np.ones(40), np.arange(n), model)
    assert found.sigma == pytest.approx(0.3, rel=0.3)
    assert found.correlation == pytest.approx(correlation, abs=0.06)
    assert found.share == pytest.approx(share, abs=0.15)


def test_a_basis_leaves_out_what_is_there_already() -> None:
    columns = np.column_stack([np.arange(6.0), np.ones(6), 2.0 * np.arange(6.0)])
    assert orthonormal(columns).shape == (6, 2)
    left = without(columns, orthonormal(columns[:, :1]))
    assert orthonormal(left, lengths(columns)).shape == (6, 1)


def test_columns_on_which_divide_and_conquer_fails_have_a_basis() -> None:
    """Columns of a real location, all but for a rotation: many squares alike, some near zero."""
    columns = np.load(Path(__file__).with_name("columns_much_alike.npy"))
    basis = orthonormal(columns, np.ones(columns.shape[1]))
    assert basis.T @ basis == pytest.approx(np.eye(basis.shape[1]), abs=1e-6)
    assert np.abs(without(columns, basis)).max() < 1e-3

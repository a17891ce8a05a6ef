"""What is left of a force and is no noise: too slow for it, or larger after reversals."""

from types import SimpleNamespace

import numpy as np
import pytest

from pipeline.discrepancy.judgement.force_rest import after_reversals, too_slow
from pipeline.discrepancy.noise.noise import SLOW_CORRELATION

ROWS, STROKE = 1200, 100


def leaving(left: np.ndarray) -> SimpleNamespace:
    """A choice that leaves (n,) of a force against a triangle's motion; a few rows do not count."""
    drive = np.abs(np.mod(np.arange(ROWS) / STROKE, 2.0) - 1.0)
    problem = SimpleNamespace(measured=left + 3.0, motion=SimpleNamespace(drive=drive))
    used = np.arange(ROWS) % 50 > 0
    return SimpleNamespace(
        fit=SimpleNamespace(ground=SimpleNamespace(used=used, problem=problem), predicted=3.0)
    )


def noise(correlation: float) -> np.ndarray:
    rng, out = np.random.default_rng(2), np.zeros(ROWS)
    for k in range(1, ROWS):
        out[k] = correlation * out[k - 1] + rng.standard_normal()
    return out


@pytest.mark.parametrize(("correlation", "slow"), [(0.0, False), (0.7, False), (0.97, True)])
def test_a_rest_that_hardly_bends_is_too_slow_for_noise(correlation, slow):
    assert too_slow(leaving(noise(correlation)), SLOW_CORRELATION) == slow


@pytest.mark.parametrize(("times", "found"), [(1.0, False), (1.2, False), (4.0, True)])
def test_a_rest_that_is_larger_after_reversals_is_no_noise(times, found):
    since = np.arange(ROWS) % STROKE
    assert after_reversals(leaving(noise(0.5) * np.where(since < 15, times, 1.0))) == found
    assert not after_reversals(leaving(noise(0.5) * np.where(since > 50, times, 1.0)))

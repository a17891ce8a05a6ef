"""A slow part that comes back is told from a zero that walks away, and from quick noise."""

import numpy as np
import pytest

from pipeline.discrepancy.noise.noise import NoiseModel
from pipeline.discrepancy.noise.wander import comes_back

ROWS, SLOWEST = 2700, 0.87
CYCLE = np.repeat(np.arange(9), ROWS // 9)
USED = np.arange(ROWS) % 11 > 0
MOVING = np.zeros(ROWS, dtype=bool)


def slow(correlation: float, rng: np.random.Generator) -> np.ndarray:
    out = np.zeros(ROWS)
    for i in range(1, ROWS):
        out[i] = correlation * out[i - 1] + np.sqrt(1.0 - correlation**2) * rng.normal()
    return out


@pytest.mark.parametrize("seed", range(3))
def test_what_keeps_to_a_level_is_no_walk(seed):
    rng = np.random.default_rng(seed)
    gain, likely = comes_back(slow(0.93, rng), CYCLE, USED, MOVING, NoiseModel(1.0), SLOWEST)
    assert gain > 23.0  # 1e-5 by chance
    assert likely.correlation == pytest.approx(0.93, abs=0.03)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("correlation", [0.0, 0.7])
@pytest.mark.parametrize("walk", [0.0, 0.05, 0.3])
def test_a_walk_of_any_size_on_quick_noise_is_one(seed, correlation, walk):
    rng = np.random.default_rng(seed)
    residual = slow(correlation, rng) + walk * np.cumsum(rng.normal(size=ROWS))
    assert comes_back(residual, CYCLE, USED, MOVING, NoiseModel(1.0), SLOWEST)[0] < 4.0

"""How much of a force's residual comes again where the motion does."""

from types import SimpleNamespace

import numpy as np
import pytest

from pipeline.discrepancy.judgement.alike import NOTHING, alike
from pipeline.physics.motion import Kinetics, Motion

ROWS = 2400


def moving() -> Motion:
    """Sines of two sizes by turns."""
    t = np.arange(ROWS) / 100.0
    x = np.where((t // 4.0) % 2 == 0, 1.0, 0.6) * np.sin(2 * np.pi * t)
    v = np.gradient(x, t)
    return Motion(
        x, t, (t // 1.0).astype(int), kinetics=Kinetics(v, np.gradient(v, t), np.zeros(ROWS))
    )


def leaving(left: np.ndarray) -> SimpleNamespace:
    """A choice that leaves (n,) of a force; a few rows do not count."""
    problem = SimpleNamespace(measured=left + 3.0, motion=moving())
    used = np.arange(ROWS) % 50 > 0
    ground = SimpleNamespace(used=used, problem=problem)
    return SimpleNamespace(fit=SimpleNamespace(ground=ground, predicted=3.0))


def noise(correlation: float, seed: int = 2) -> np.ndarray:
    rng, out = np.random.default_rng(seed), np.zeros(ROWS)
    for k in range(1, ROWS):
        out[k] = correlation * out[k - 1] + rng.standard_normal()
    return out / out.std()


@pytest.mark.parametrize("correlation", [0.0, 0.6, 0.9])
def test_noise_does_not_come_again_however_it_is_correlated(correlation):
    for seed in range(5):
        found = alike(leaving(noise(correlation, seed)))
        assert not found.sure
        assert abs(found.share) < 0.3


@pytest.mark.parametrize("size", [1.5, 4.0])
def test_a_law_of_the_motion_comes_again_as_far_as_it_is_of_the_residual(size):
    kinetics, x = moving().kinetics, moving().drive
    law = np.tanh(3.0 * kinetics.velocity / 6.0) * x**2 + 0.3 * np.sin(4.0 * x)
    found = alike(leaving(size * law / law.std() + noise(0.3)))
    assert found.sure
    assert found.share == pytest.approx(size**2 / (1.0 + size**2), abs=0.15)


def test_a_zero_that_wanders_does_not_come_again():
    slow = 2.0 * np.cos(np.arange(ROWS) / 400.0)
    assert not alike(leaving(noise(0.3) + slow)).sure


def test_few_rows_tell_nothing():
    choice = leaving(noise(0.0))
    choice.fit.ground.used = np.arange(ROWS) < 80
    assert alike(choice) == NOTHING

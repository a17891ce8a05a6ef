"""A bank of stops at the drive: Prandtl and Ishlinskii's operator, its loops, its memory."""

import numpy as np
import pytest

from pipeline.physics.catalogue import richer, term
from pipeline.physics.driven_bank import stops_of
from pipeline.physics.motion import Motion

SWING = np.linspace(20.0, 8.0, 4000) * np.sin(np.arange(4000) / 200.0)


def motion_of(drive: np.ndarray) -> Motion:
    n = len(drive)
    return Motion(drive, 0.02 * np.arange(n), np.zeros(n, dtype=int))


def held_back(drive: np.ndarray, values: list[float], form: str = "driven bank") -> np.ndarray:
    """By how much the joint is behind the drive, (n,)."""
    x, _ = term("friction", form).respond(drive, motion_of(drive), np.array(values), None)
    return drive - x


def prandtl_ishlinskii(drive: np.ndarray, reaches: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Weighted stops that begin unstressed, (n,)."""
    out, stretch = np.zeros(len(drive)), np.zeros(len(reaches))
    for k in range(1, len(drive)):
        stretch = np.clip(stretch + drive[k] - drive[k - 1], -reaches, reaches)
        out[k] = weights @ stretch
    return out


@pytest.mark.parametrize("spread", [0.0, 0.6, 1.0, 1.7, 2.0, 2.5])
def test_it_is_prandtl_and_ishlinskiis_operator(spread):
    width, reach = 2.0, 9.0
    reaches = reach * stops_of(spread)
    expected = prandtl_ishlinskii(SWING, reaches, 0.5 * width / len(reaches) / reaches)
    np.testing.assert_allclose(held_back(SWING, [width, reach, spread]), expected, atol=1e-9)


@pytest.mark.parametrize(
    ("spread", "quantile"),
    [
        (0.0, lambda p: np.ones(len(p))),
        (1.0, lambda p: 2.0 * p),
        (2.0, lambda p: -np.log(1.0 - p)),
    ],
)
def test_its_stops_are_spread_as_said(spread, quantile):
    expected = quantile((np.arange(8) + 0.5) / 8)
    np.testing.assert_allclose(stops_of(spread), expected / expected.mean(), rtol=1e-9)


def test_its_spread_goes_from_one_distribution_to_the_other_without_a_step():
    for spread in (1.0, 2.0):
        before, after = stops_of(spread - 1e-6), stops_of(spread + 1e-6)
        np.testing.assert_allclose(before, after, rtol=1e-4)
        assert np.all(np.diff(before) > 0.0)


def test_the_joint_never_moves_against_the_drive():
    x = SWING - held_back(SWING, [12.0, 0.1, 2.5, 0.8], "driven bank asymmetric")
    assert np.all(np.diff(x) * np.diff(SWING) >= -1e-9)


def test_it_holds_back_more_in_one_direction():
    wide = held_back(SWING, [2.0, 1.5, 1.0, 0.5], "driven bank asymmetric")
    assert wide.max() == pytest.approx(1.5)
    assert wide.min() == pytest.approx(-0.5)


def test_a_block_goes_on_where_the_one_before_ended():
    values, bank = np.array([3.0, 4.0, 1.2]), term("friction", "driven bank")
    whole, _ = bank.respond(SWING, motion_of(SWING), values, None)
    first, state = bank.respond(SWING[:1500], motion_of(SWING[:1500]), values, None)
    second, _ = bank.respond(SWING[1500:], motion_of(SWING[1500:]), values, state)
    np.testing.assert_allclose(np.concatenate([first, second]), whole)


def test_friction_that_the_drive_bends_grows_to_it():
    assert "driven bank" in [t.form for t in richer(term("friction", "driven"))]

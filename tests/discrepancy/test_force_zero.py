"""Forces at one pace in correlated noise: no drift and no law is told that only follows that."""

import numpy as np
import pytest

from pipeline.config import DiagnosisConfig, SimulationConfig
from pipeline.discrepancy.search.force_zero import in_order
from pipeline.stages.diagnosis import diagnose
from pipeline.stages.simulation import simulate
from tests.discrepancy.test_force import RATE, recording

NOISE = 0.5


def paced(cycles, samples):
    """Position [m] and speed [m/s] of a sine with so many samples a cycle, (n,) each."""
    x = 0.05 * np.sin(2.0 * np.pi * np.arange(cycles * samples) / samples)
    return x, np.gradient(x, 1.0 / RATE)


def correlated(rng, count, by):
    """A first-order autoregression of deviation NOISE, (n,)."""
    fresh, out = rng.normal(0.0, NOISE, count), np.empty(count)
    out[0] = fresh[0]
    for k in range(1, count):
        out[k] = by * out[k - 1] + np.sqrt(1.0 - by**2) * fresh[k]
    return out


def told(x, force):
    """The names and the verdict of a force against a motion, each (n,)."""
    seen = simulate(SimulationConfig("mechanism"), recording(x, force))
    found = diagnose(DiagnosisConfig(), seen).diagnoses[0]
    return {p.name for p in found.physics}, found.verdict


@pytest.mark.parametrize("seed", [0, 5])
def test_a_zero_that_jitters_from_cycle_to_cycle_is_no_drift(seed):
    rng = np.random.default_rng(seed)
    x, v = paced(9, 180)
    zeros = rng.normal(0.0, NOISE, 9)[np.arange(len(x)) // 180]
    force = 4.0 * v / np.std(v) + zeros + correlated(rng, len(x), 0.55)
    assert told(x, force) == ({"viscous_friction"}, "explained")


def test_a_zero_that_rises_is_a_drift_all_the_same():
    rng = np.random.default_rng(7)
    x, v = paced(9, 180)
    rising = np.linspace(0.0, 6.0 * NOISE, len(x))
    force = 4.0 * v / np.std(v) + rising + correlated(rng, len(x), 0.55)
    assert told(x, force) == ({"viscous_friction", "drift"}, "explained")


@pytest.mark.parametrize("late_s", [0.5, 1.5])
def test_a_zero_that_settles_from_far_off_is_a_drift_and_no_calibration_error(late_s):
    rng = np.random.default_rng(3)
    x, v = paced(7, 180)
    settling = -60.0 * NOISE * np.exp(-np.arange(len(x)) / RATE / late_s)
    settling -= settling.mean()
    force = 40.0 * v / np.std(v) + settling + correlated(rng, len(x), 0.0)
    seen = simulate(SimulationConfig("mechanism"), recording(x, force))
    (found,) = diagnose(DiagnosisConfig(), seen).diagnoses
    assert {p.name for p in found.physics} == {"viscous_friction", "drift"}
    assert not any("more than 5 tolerances off" in note for note in found.notes)


def test_zeros_in_their_order_are_told_from_independent_ones():
    cycle = np.repeat(np.arange(12), 50)
    rng = np.random.default_rng(2)
    ones = [in_order(np.repeat(rng.standard_normal(12), 50), cycle) for _ in range(200)]
    walks = [in_order(np.repeat(rng.standard_normal(12).cumsum(), 50), cycle) for _ in range(200)]
    assert np.mean(ones) < 0.03
    assert np.mean(walks) > 0.5
    assert not in_order(np.arange(200.0), cycle[:200])


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_dry_and_viscous_friction_are_no_power_of_the_speed(seed):
    rng = np.random.default_rng(seed)
    x, v = paced(4, 200)
    turning = np.clip(np.convolve(np.sign(v), np.ones(3) / 3.0, "same"), -1.0, 1.0)
    force = 1.4 * v / np.std(v) + 1.4 * turning + correlated(rng, len(x), 0.6)
    assert told(x, force)[0] == {"viscous_friction", "coulomb_friction"}

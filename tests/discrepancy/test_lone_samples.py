"""Samples of a force that stand alone: named, kept out of means, and not taken for friction."""

import numpy as np
import pandas as pd
import pytest

from pipeline.config import DiagnosisConfig
from pipeline.recording import Channel, Recording, with_context
from pipeline.stages.diagnosis import diagnose

RATE, PERIOD, NOISE = 40.0, 3.1, 0.2


def swung(seed, error, simulated=lambda x, v: 300.0 * x, more=lambda x, v: 0.0 * x):
    """A spring swung by two sines, with what a simulation has and what it has not, and errors."""
    rng = np.random.default_rng(seed)
    t = np.arange(1400) / RATE
    x = 0.03 * np.sin(2 * np.pi * t / PERIOD) + 0.008 * np.sin(2 * np.pi * t / 1.37)
    v = np.gradient(x, t)
    said = simulated(x, v)
    channels = (
        Channel("position_m", "command", "m"),
        Channel("force_n", "measurement", "N"),
        Channel("simulated_n", "simulation", "N", of="force_n"),
    )
    table = {"time_s": t, "position_m": x, "force_n": said + more(x, v) + error(rng, t, v)}
    samples = pd.DataFrame({**table, "simulated_n": said})
    return Recording(with_context(samples, channels), channels, "simulated")


def mistaken(rng, t, v):
    """Noise, and 2 % of samples that show anything within 8 N."""
    error = rng.normal(0.0, NOISE, len(t))
    return np.where(rng.random(len(t)) < 0.02, rng.uniform(-8.0, 8.0, len(t)), error)


def told(recording):
    found = diagnose(DiagnosisConfig(), recording)
    return found.diagnoses[0], found.evidence[0]


@pytest.mark.parametrize("friction", [0.0, 2.0])
def test_mistaken_samples_of_a_force_are_named_and_bend_nothing(friction):
    found, evidence = told(swung(3, mistaken, more=lambda x, v: friction * np.tanh(v / 0.02)))
    by_name = {p.name: p for p in found.physics}
    assert set(by_name) == {"marker_outliers", *(["coulomb_friction"] if friction else [])}
    share, size = by_name["marker_outliers"].parameters
    assert share.low < 0.02 < share.high
    assert 3.0 < size.value < 5.5
    assert found.verdict == "explained"
    assert found.noise == pytest.approx(NOISE, rel=0.1)
    assert found.after.heldout_rmse == pytest.approx(NOISE, rel=0.15)
    assert evidence.mistaken.sum() > 15
    assert not (evidence.mistaken & evidence.used).any()
    assert "marker_outliers" not in found.not_excited


def test_what_breaks_loose_at_each_reversal_is_no_mistaken_sample():
    def loose(rng, t, v):
        turned = np.flatnonzero(np.diff(np.sign(v)))
        peaks = np.zeros(len(t))
        peaks[turned + 1] = 6.0 * np.sign(v[turned + 1]) * rng.uniform(0.7, 1.0, len(turned))
        return peaks + rng.normal(0.0, NOISE, len(t))

    found, evidence = told(swung(4, loose))
    assert not evidence.mistaken.any()
    assert "marker_outliers" not in {p.name for p in found.physics}


def test_heavy_tails_of_a_force_are_no_mistaken_samples():
    found, _ = told(swung(5, lambda rng, t, v: NOISE * rng.standard_t(2.5, len(t))))
    assert "marker_outliers" not in {p.name for p in found.physics}

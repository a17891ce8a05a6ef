"""Tables in compiled loops against the functions that they stand for."""

import numpy as np

from pipeline.physics.decay import decayed
from pipeline.physics.tabled import RAMPS, WAVE, ramped, waved


def test_a_decay_is_the_exponential():
    x = np.concatenate([np.linspace(0.0, 31.9, 20_001), [40.0, 1e300]])
    np.testing.assert_allclose([decayed(value) for value in x], np.exp(-x), atol=1e-11)


def test_ramps_and_waves_are_what_their_equations_say():
    x = np.linspace(-13.9, 13.9, 20_001)
    ramp, wave = np.array([ramped(v) for v in x]), np.array([waved(v) for v in x])
    np.testing.assert_allclose(ramp[:, 0], np.log1p(np.exp(x)), atol=1e-9)
    np.testing.assert_allclose(ramp[:, 1], 1.0 / (1.0 + np.exp(-x)), atol=1e-7)
    np.testing.assert_allclose(wave, np.column_stack([np.sin(x), np.cos(x)]), atol=1e-11)


def test_what_is_no_number_reads_no_table_beyond_its_end():
    assert np.all(np.isfinite(RAMPS))
    assert np.all(np.isfinite(WAVE))
    assert np.all(np.isnan([decayed(np.nan), ramped(np.nan)[0], waved(np.nan)[0]]))

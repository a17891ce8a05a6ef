"""A lag of second order: what is kept from one dwell to the next."""

import numpy as np
import pytest

from pipeline.physics.second_order_lag import swung


@pytest.mark.parametrize("damping", [0.2, 1.0, 1.7])
@pytest.mark.parametrize("frequency", [0.3, 20.0])
def test_dwells_that_differ_little_answer_as_each_alone(frequency: float, damping: float) -> None:
    rng = np.random.default_rng(8)
    signal = np.cumsum(rng.normal(0.0, 1.0, 300))
    dwell = 3.36 + rng.uniform(-0.01, 0.01, 300) + 7.0 * (np.arange(300) % 50 == 0)
    together, _ = swung(signal, dwell, 0.2 * dwell, frequency, damping, signal[0], np.zeros(2))
    alone, state = [], np.array([0.0, 0.0, signal[0]])
    for k in range(300):
        out, state = swung(
            signal[k : k + 1],
            dwell[k : k + 1],
            0.2 * dwell[k : k + 1],
            frequency,
            damping,
            state[2],
            state[:2],
        )
        alone.append(out[0])
    np.testing.assert_allclose(together, alone, rtol=0.0, atol=1e-10)

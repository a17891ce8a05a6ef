"""Whether samples follow each other so evenly that counting them is a clock."""

import numpy as np
import pytest

from pipeline.physics.held import uneven


@pytest.mark.parametrize(
    ("step_s", "by", "told"),
    [(3.0, 0.008, True), (3.0, 0.003, False), (0.1, 0.04, False), (0.1, 0.06, True)],
)
def test_of_a_robot_that_waits_half_a_percent_is_uneven(step_s: float, by: float, told: bool):
    gaps = step_s * (1.0 + by * np.resize([-1.0, 1.0], 200))
    assert uneven(np.cumsum(gaps)) == told

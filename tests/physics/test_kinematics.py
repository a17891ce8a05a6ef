"""The nominal curve and its smooth error."""

import numpy as np

from pipeline.physics.kinematics import SmoothError


def test_beyond_its_range_a_smooth_error_hardly_more_than_doubles():
    error = SmoothError(middle=0.0, half_range=40.0, weights=(0.0, 0.0, 0.3))
    end, beyond, far = error(np.array([40.0, 44.0, 80.0]), {})
    assert end < beyond < 2.3 * end
    assert far == beyond

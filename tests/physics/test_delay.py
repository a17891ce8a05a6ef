"""A signal a moment ago: exact for a cubic, near for a sine, and of all parts of a motion."""

import numpy as np
import pytest

from pipeline.physics.delay import delayed
from pipeline.physics.motion import Kinetics, Motion

TIME_S = np.array([0.0, 0.1, 0.25, 0.3, 0.5, 0.6, 0.72, 0.9])


@pytest.mark.parametrize("delay_s", [0.0, 0.04, -0.04])
def test_a_cubic_is_delayed_exactly(delay_s):
    def cubic(t):
        return 2.0 - t + 3.0 * t**2 - 4.0 * t**3

    assert delayed(TIME_S, cubic(TIME_S), delay_s) == pytest.approx(cubic(TIME_S - delay_s))


def test_a_motion_is_delayed_with_its_derivatives_and_its_times_stay():
    time_s = np.arange(400) / 200.0
    w = 2.0 * np.pi * 3.0
    kinetics = Kinetics(w * np.cos(w * time_s), -(w**2) * np.sin(w * time_s), np.sin(w * time_s))
    motion = Motion(np.sin(w * time_s), time_s, np.zeros(400, dtype=np.int64), kinetics=kinetics)
    late = motion.delayed(0.002)
    then = w * (time_s - 0.002)
    assert late.drive == pytest.approx(np.sin(then), abs=1e-4)
    assert late.kinetics is not None
    assert late.kinetics.velocity == pytest.approx(w * np.cos(then), abs=1e-4 * w)
    assert late.kinetics.acceleration == pytest.approx(-(w**2) * np.sin(then), abs=1e-4 * w**2)
    assert late.kinetics.simulated == pytest.approx(late.drive)
    assert late.time_s is motion.time_s
    assert motion.delayed(0.0) is motion

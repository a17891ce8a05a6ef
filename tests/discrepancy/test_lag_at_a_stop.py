"""A joint that comes late and meets a stop, sampled more often than it steps."""

import numpy as np

from tests.discrepancy.made import diagnosed, followed, names, value_of

NOISE, LAG_S, STOP = 0.2, 0.5, -18.0


def test_a_joint_that_comes_late_up_to_a_stop_lags_and_stops_and_does_nothing_else():
    time_s = 0.07 * np.arange(2000)
    levels = 7.0 * np.array([1, 2, 3, 4, 3, 2, 1, 0, -1, -2, -3, -4, -3, -2, -1, 0])
    dwell = [20, 9, 9, 9, 4, 20, 4, 20, 20, 4, 9, 20, 4, 4, 9, 11]
    ends = np.cumsum(np.column_stack([np.full(16, 3.0), dwell]).ravel())
    once = np.interp(np.arange(250) % ends[-1], np.r_[0.0, ends], np.r_[0.0, np.repeat(levels, 2)])
    drive = np.tile(once, 8)
    finely = np.interp(np.arange(0.0, time_s[-1], 0.001), time_s, drive)
    at, fine = 0.0, np.empty(len(finely))
    for k, asked in enumerate(finely):
        at = max(at + (asked - at) * 0.001 / LAG_S, STOP)
        fine[k] = at
    seen = np.interp(time_s, np.arange(0.0, time_s[-1], 0.001), fine)
    seen += NOISE * np.random.default_rng(3).standard_normal(len(seen))
    found = diagnosed(followed(time_s, drive, seen, 1.0 / (0.07 * 250)))
    assert names(found) == {"response_lag", "end_stop"}
    assert found.diagnoses[0].verdict == "explained"
    lag = value_of(found, "response_lag", "time_constant")
    assert lag.low < LAG_S < lag.high

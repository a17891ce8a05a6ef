"""Delay: what a signal was a moment ago."""

import numpy as np
from scipy.interpolate import CubicSpline


def delayed(time_s: np.ndarray, values: np.ndarray, delay_s: float) -> np.ndarray:
    """Finite values (n,) as they were `delay_s` before each of the rising times (n,).

    By a cubic spline, which goes on beyond the first and the last of them.
    """
    return np.ascontiguousarray(CubicSpline(time_s, values)(time_s - delay_s))

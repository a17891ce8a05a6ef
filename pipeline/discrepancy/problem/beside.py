"""Whether a measurement goes along with what a drive does beside a smooth motion."""

import numpy as np

from pipeline.discrepancy.problem.outliers import robust_deviation

FOLLOWS, SURELY, LATEST = 0.5, 4.0, 12


def may_follow(
    beside: np.ndarray, smooth: np.ndarray, measured: np.ndarray, usual: float = np.inf
) -> bool:
    """Whether a measurement (n,) may follow what is beside a smooth motion (n,): steps, or noise.

    measured: NaN where not measured. Second differences of both, which leave next to nothing of a
    smooth motion, at each delay; what is further off than `usual` robust deviations is cut, as the
    corners of a motion that is smooth but for them.
    """
    rows = np.flatnonzero(np.isfinite(measured))
    gain, offset = np.polyfit(smooth[rows], measured[rows], 1)
    y = cut(np.diff((measured - gain * smooth - offset)[rows], 2), usual)
    for late in range(LATEST):
        x = cut(gain * np.diff(np.roll(beside, late)[rows], 2), usual)
        square = float(x @ x)
        if square == 0.0:
            return True
        share = float(y @ x) / square
        error = float(np.sqrt(np.mean((y - share * x) ** 2) / square))
        if share + SURELY * error > FOLLOWS:
            return True
    return False


def cut(values: np.ndarray, usual: float) -> np.ndarray:
    """Values (n,), none further off than `usual` robust deviations."""
    if np.isinf(usual):
        return values
    far = usual * robust_deviation(values)
    return np.asarray(np.clip(values, -far, far))

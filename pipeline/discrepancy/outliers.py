"""Outliers: samples that stand off from their neighbours on both sides."""

import numpy as np

from pipeline.discrepancy.noise_learning import robust_deviation

ISOLATED = 5.0


def isolated(residual: np.ndarray, train: np.ndarray, finest: float) -> np.ndarray:
    """Mask (n,) of residuals that are off from their neighbours' median by ISOLATED deviations.

    residual: (n,), NaN where not measured. The deviation of that distance is learnt from `train`
    and is at least `finest`.
    """
    known = np.flatnonzero(np.isfinite(residual))
    out = np.zeros(len(residual), dtype=bool)
    if len(known) < 7:
        return out
    r = residual[known]
    around = np.stack([np.roll(r, k) for k in (-2, -1, 1, 2)])
    off = r - np.median(around, axis=0)
    off[:2] = r[:2] - np.median(r[:5])
    off[-2:] = r[-2:] - np.median(r[-5:])
    scale = max(robust_deviation(off[train[known]]), finest)
    out[known] = np.abs(off) > ISOLATED * scale
    return out

"""Weights of contrasts over repeats: they cancel what repeats, and what grows with the repeats."""

import numpy as np

FEWEST_STEPS = 12


def few(steps: np.ndarray) -> bool:
    """Whether a cycle's steps, a mask, are too few for contrasts: FEWEST_STEPS do, or a third."""
    return bool(steps.sum() < min(FEWEST_STEPS, len(steps) // 3))


def numbered(rows: np.ndarray) -> np.ndarray:
    """When each of some repeats (repeats, steps) of row numbers came, over all, (repeats,)."""
    number = np.max(rows, axis=1).astype(float)
    return np.asarray((number - number.mean()) / max(float(np.ptp(number)), 1e-9))


def free_of(number: np.ndarray, degree: int) -> np.ndarray:
    """Orthonormal weights (n, n - degree - 1) that cancel a polynomial in numbers (n,)."""
    return np.asarray(np.linalg.svd(np.vander(number, degree + 1))[0][:, degree + 1 :])

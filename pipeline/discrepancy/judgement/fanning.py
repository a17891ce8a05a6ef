"""Errors that spread from a place on: a gain that changes, and no zero that does."""

import numpy as np
from scipy.special import fdtrc

from pipeline.recording import branch_of

LEVELS, INSIDE, NEAR = 11, 0.05, 2
FEWEST = 8


def even_by_chance(drive: np.ndarray, off: np.ndarray) -> float:
    """How likely errors vary so differently from place to place by chance.

    drive: (n,). off: errors (n,), NaN where none counts. What moves the zero varies alike wherever
    the drive is; what comes of a gain that changes varies the more, the farther it is from where
    that counts from. Fisher's ratio of the largest variance over LEVELS places to the smallest, of
    half as many values as passages, since these come in pairs, there and back. Bonferroni over the
    pairs of places. 1 where too few passages are.
    """
    low, high = float(drive.min()), float(drive.max())
    margin = INSIDE * (high - low)
    found = [passed(drive, off, at) for at in np.linspace(low + margin, high - margin, LEVELS)]
    seen = [(float(e @ e) / (len(e) - 2), 0.5 * (len(e) - 2)) for e in found if len(e) >= FEWEST]
    if len(seen) < 2 or min(seen)[0] <= 0.0:
        return 1.0
    most, least = max(seen), min(seen)
    pairs = len(seen) * (len(seen) - 1)
    return min(pairs * float(fdtrc(most[1], least[1], most[0] / least[0])), 1.0)


def passed(drive: np.ndarray, off: np.ndarray, place: float) -> np.ndarray:
    """Mean errors at each passage of a place, less what those in its direction have in common."""
    passages = np.flatnonzero((drive[:-1] - place) * (drive[1:] - place) <= 0.0)
    passages = passages[(passages >= NEAR) & (passages < len(drive) - NEAR - 1)]
    passages = passages[np.diff(passages, prepend=-np.inf) > 2 * NEAR]
    about = off[passages[:, None] + np.arange(1 - NEAR, NEAR + 1)]
    known = np.isfinite(about)
    enough = known.sum(axis=1) >= NEAR
    way = branch_of(drive)[passages[enough] + 1]
    means = np.where(known, about, 0.0)[enough].sum(axis=1) / known[enough].sum(axis=1)
    for direction in (-1, 1):
        own = way == direction
        means[own] -= means[own].mean() if own.any() else 0.0
    return np.asarray(means)

"""Noise that is louder at some angles than at others."""

import numpy as np

from pipeline.discrepancy.problem.outliers import robust_deviation
from pipeline.number_words import worded

PLACES, FEWEST, SURE = 8, 20, 4.0
WORTH_SAYING, STANDS = 1.5, 100.0


def loudness(errors: np.ndarray, along: np.ndarray, train: np.ndarray) -> np.ndarray:
    """How many times louder than usual the noise is in each row, (n,), nowhere less than 1.

    errors: (n,) of a fit, along: (n,) its angle, train: (n,) rows to judge by. PLACES ranges of as
    many rows each are compared with all by their median absolute deviations, which few mistaken
    rows don't move. One of m rows is known to 0.83 / sqrt(m) of itself: what is less than SURE of
    these more is none.
    """
    rows = np.flatnonzero(train & np.isfinite(errors))
    usual = robust_deviation(errors[rows])
    if len(rows) < PLACES * FEWEST or usual == 0.0:
        return np.ones(len(errors))
    parts = np.array_split(rows[np.argsort(along[rows], kind="stable")], PLACES)
    middles = [float(np.median(along[part])) for part in parts]
    ratios = np.array([robust_deviation(errors[part]) for part in parts]) / usual
    least = 1.0 + SURE * 0.83 / np.sqrt(len(parts[-1]))
    return np.asarray(np.interp(along, middles, np.where(ratios > least, ratios, 1.0)))


def loud_note(errors: np.ndarray, along: np.ndarray, train: np.ndarray, unit: str) -> list[str]:
    """Where the noise is much louder than usual, in words; nothing where it is nowhere.

    Nor where it is so by more than STANDS: a joint that mostly stands still has no usual noise.
    """
    louder = np.where(train, loudness(errors, along, train), 0.0)
    most = int(np.argmax(louder))
    if not WORTH_SAYING <= louder[most] < STANDS:
        return []
    return [
        f"The noise is up to {worded(louder[most])} times as large as usual, about "
        f"{worded(along[most])} {unit}: what stands off there is judged by that."
    ]

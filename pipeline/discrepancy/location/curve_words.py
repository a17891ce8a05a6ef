"""What shape a curve has, in words: from an angle on, towards the ends, periodic, or smooth."""

import numpy as np

from pipeline.number_words import worded

BINS = 160
SIMPLER = 0.03
NOTHING = 1e-10
RECOGNISED = 0.6


def binned(x: np.ndarray, y: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Mean x, mean y and number of samples in each of at most `count` even bins that has any."""
    low, span = float(np.min(x)), float(np.ptp(x))
    number = np.zeros(len(x), dtype=int)
    if span > 0:
        number = np.minimum((count * (x - low) / span).astype(int), count - 1)
    size = np.bincount(number, minlength=count)
    some = size > 0
    mean_x = np.bincount(number, x, count)[some] / size[some]
    return mean_x, np.bincount(number, y, count)[some] / size[some], size[some].astype(float)


def least_squares_share(
    columns: np.ndarray, y: np.ndarray, beside: np.ndarray, weight: np.ndarray
) -> float:
    """Share of y, (k,), that columns (k, p) explain beyond those beside (k, j); weight (k,)."""
    return float(least_squares_shares(columns[None], y, beside, weight)[0])


def least_squares_shares(
    columns: np.ndarray, y: np.ndarray, beside: np.ndarray, weight: np.ndarray
) -> np.ndarray:
    """The same for each of many sets of columns, (c, k, p), shape (c,)."""
    base = _span(beside * weight[:, None])
    left = y * weight
    left = left - base @ (base.T @ left)
    power = float(left @ left)
    if power <= 0.0:
        return np.zeros(len(columns))
    weighted = columns * weight[:, None]
    size = np.linalg.norm(weighted, axis=1)
    free = weighted - base @ (base.T @ weighted)
    q, r = np.linalg.qr(free)
    strong = np.abs(np.diagonal(r, axis1=1, axis2=2)) > NOTHING * np.maximum(size, 1e-300)
    along = np.einsum("ckp,k->cp", q, left) * strong
    return np.sum(along**2, axis=1) / power


def curve_words(x: np.ndarray, y: np.ndarray, position: np.ndarray, unit: str) -> str:
    """Where along x a residual y differs most simply; gain on `position` and offset are free.

    x, y, position: (m,). unit: "deg of command" or the like.
    """
    centre, mean, count = binned(x, y, BINS)
    _, place, _ = binned(x, position, BINS)
    if len(centre) < 6:
        return "with the command"
    weight = np.sqrt(count)
    beside = np.column_stack([np.ones(len(centre)), np.nan_to_num(place)])
    tried = [
        _smooth(centre, mean, beside, weight),
        _one_side(centre, mean, beside, weight, unit),
        _both_sides(centre, mean, beside, weight, unit),
        _periodic(centre, mean, beside, weight, unit),
    ]
    share, words = tried[0]
    for other_share, other_words in tried[1:]:
        if other_share > share + SIMPLER:
            share, words = other_share, other_words
    return words if share > RECOGNISED else "unevenly over the whole range"


def _smooth(
    x: np.ndarray, y: np.ndarray, beside: np.ndarray, weight: np.ndarray
) -> tuple[float, str]:
    scaled = (x - x.mean()) / (np.ptp(x) or 1.0)
    powers = np.column_stack([scaled**2, scaled**3])
    return least_squares_share(powers, y, beside, weight), "as a smooth bend over the whole range"


def _one_side(
    x: np.ndarray, y: np.ndarray, beside: np.ndarray, weight: np.ndarray, unit: str
) -> tuple[float, str]:
    begins = np.linspace(x[0], x[-1], 60)[3:-3]
    ramps = np.maximum(0.0, x - begins[:, None])[:, :, None]
    shares = least_squares_shares(ramps, y, beside, weight)
    best = int(np.argmax(shares))
    way = "positive" if begins[best] > 0.5 * (x[0] + x[-1]) else "negative"
    return float(shares[best]), f"beyond {worded(begins[best])} {unit} on the {way} side"


def _both_sides(
    x: np.ndarray, y: np.ndarray, beside: np.ndarray, weight: np.ndarray, unit: str
) -> tuple[float, str]:
    reach = min(-x[0], x[-1])
    if reach <= 0:
        return 0.0, ""
    widths = np.linspace(0.0, reach, 40)[1:-2]
    clipped = np.clip(x, -widths[:, None], widths[:, None])[:, :, None]
    shares = least_squares_shares(clipped, y, beside, weight)
    best = int(np.argmax(shares))
    if widths[best] < 0.35 * reach:
        return float(shares[best]), f"within {widths[best]:.2g} {unit} of home"
    return float(shares[best]), f"beyond {worded(widths[best])} {unit} on both sides"


def _periodic(
    x: np.ndarray, y: np.ndarray, beside: np.ndarray, weight: np.ndarray, unit: str
) -> tuple[float, str]:
    span = float(np.ptp(x))
    finest = max(4.0 * span / len(x), 0.02 * span)
    turns = np.arange(1.5, span / finest, 0.125)
    if len(turns) == 0:
        return 0.0, ""
    shares = _wave_shares(turns, x, y, beside, weight)
    coarse = float(turns[int(np.argmax(shares))])
    near = coarse + np.linspace(-0.125, 0.125, 21)
    shares = _wave_shares(near, x, y, beside, weight)
    best = int(np.argmax(shares))
    return float(shares[best]), f"periodically, every {worded(span / near[best])} {unit}"


def _wave_shares(
    turns: np.ndarray, x: np.ndarray, y: np.ndarray, beside: np.ndarray, weight: np.ndarray
) -> np.ndarray:
    angle = 2.0 * np.pi * turns[:, None] * x / float(np.ptp(x))
    return least_squares_shares(np.stack([np.cos(angle), np.sin(angle)], 2), y, beside, weight)


def _span(base: np.ndarray) -> np.ndarray:
    q, r = np.linalg.qr(base)
    return q[:, np.abs(np.diag(r)) > NOTHING * max(float(np.abs(r).max()), 1e-300)]

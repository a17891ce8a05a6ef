"""Outliers: samples, alone or a few in a row, that stand off from those on both sides."""

from collections.abc import Sequence

import numpy as np

from pipeline.discrepancy.problem.spikes import LARGEST_SHARE, NEIGHBOURS, off_both_sides
from pipeline.recording import branch_of

ISOLATED = 5.0
RETURNS, FEWEST_REPEATS, MOST = 0.5, 3, 0.65
FEWEST_KIN = 4
SHORT, LONGEST, OF_CYCLE = 5, 12, 0.06
TOGETHER = 0.6
SUDDEN, BACK, EVEN, SEEN = 0.6, 0.5, 0.4, 4


def isolated(
    residual: np.ndarray,
    train: np.ndarray,
    finest: float,
    cycle: np.ndarray,
    repeats: Sequence[np.ndarray] = (),
) -> np.ndarray:
    """Mask (n,) of residuals that are off from their neighbours' median by ISOLATED deviations.

    residual: (n,), NaN where not measured. The deviation of that distance is learnt from `train`
    and is at least `finest`. Of a few in a row, no more than a small part of a cycle (n,), see
    `bursts`; what stands beside one is compared with what is beyond it. What stands off in most
    `repeats` as well does not count, see `returning`.
    """
    in_rows = bursts(residual, train, finest, cycle, repeats)
    off = distances(np.where(in_rows, np.nan, residual))
    known = np.isfinite(off)
    if not known.any():
        return in_rows
    scale = max(robust_deviation(off[train & known]), finest)
    lone = known & (np.abs(off) > ISOLATED * scale) & ~returning(off, repeats)
    found = lone | in_rows
    measured = found[np.isfinite(residual)]
    beside = np.convolve(measured, [1, 0, 1], mode="same")[measured] > 0
    if np.mean(measured) > LARGEST_SHARE and np.mean(beside) > TOGETHER:
        return np.zeros(len(residual), dtype=bool)
    return np.asarray(found)


def bursts(
    residual: np.ndarray,
    train: np.ndarray,
    finest: float,
    cycle: np.ndarray,
    repeats: Sequence[np.ndarray] = (),
) -> np.ndarray:
    """Mask (n,) of residuals that are off in a row: the camera saw another thing for a while.

    They stand off from what was before and after by ISOLATED deviations of such a distance, and get
    there at once and at once back to where they were: a corner, a jump that stays and a slow wave
    do not, and what swings was not at rest before and after. The shortest are found first and then
    passed over. Two that follow each other at once, or with one in SEEN seen right, are one, to
    whichever sides.
    """
    out = np.zeros(len(residual), dtype=bool)
    longest = longest_burst(cycle)
    for length in range(2, longest + 1):
        known = np.flatnonzero(np.isfinite(residual) & ~out)
        if len(known) < 2 * (longest + NEIGHBOURS):
            break
        out[known[runs_off(residual[known], train[known], finest, length)]] = True
    if not out.any():
        return out
    return out & ~returning(heights(residual, longest), repeats)


def longest_burst(cycle: np.ndarray) -> int:
    """How many samples in a row may be a burst where each belongs to a cycle (n,)."""
    usual = float(np.median(np.unique(cycle, return_counts=True)[1]))
    return int(np.clip(OF_CYCLE * usual, SHORT, LONGEST))


def runs_off(values: np.ndarray, train: np.ndarray, finest: float, length: int) -> np.ndarray:
    """Mask (m,) of values (m,) in runs of one length that are a burst, see `bursts`."""
    out = np.zeros(len(values), dtype=bool)
    distance = off_both_sides(values, length - 1)[1]
    scale = max(robust_deviation(distance[:, train].ravel()), finest)
    step = np.abs(np.diff(values))
    leaps = (step > SUDDEN * ISOLATED * scale)[NEIGHBOURS - 1 : len(step) - NEIGHBOURS + 1]
    first = np.flatnonzero(leaps[:-length] & leaps[length:]) + NEIGHBOURS
    if not len(first):
        return out
    beside = np.arange(NEIGHBOURS)
    sides = values[first[:, None] - 1 - beside], values[first[:, None] + length + beside]
    before, after = (np.median(side, axis=1) for side in sides)
    middle, apart = 0.5 * (before + after), np.abs(after - before)
    uneven = np.maximum(*(np.ptp(side, axis=1) for side in sides))
    rows = first[:, None] + np.arange(length)
    off = np.abs(values[rows] - middle[:, None])
    height = np.sort(off, axis=1)[:, length // SEEN] - 0.5 * apart
    sudden = (step[first - 1] > SUDDEN * off[:, 0]) & (step[rows[:, -1]] > SUDDEN * off[:, -1])
    found = sudden & (height > ISOLATED * scale)
    found &= (apart < BACK * height) & (uneven < EVEN * height)
    out[rows[found]] = True
    return out


def heights(residual: np.ndarray, longest: int) -> np.ndarray:
    """How far residuals (n,) are off both what was before and what comes after.

    See `off_both_sides`: the `longest` in a row are none of the samples each is compared with.
    """
    out = np.zeros(len(residual))
    known = np.flatnonzero(np.isfinite(residual))
    out[known] = off_both_sides(residual[known], longest - 1)[0]
    return out


def distances(residual: np.ndarray) -> np.ndarray:
    """How far residuals (n,) are off from their neighbours' median; NaN where not measured."""
    known = np.flatnonzero(np.isfinite(residual))
    out = np.full(len(residual), np.nan)
    if len(known) < 7:
        return out
    r = residual[known]
    around = np.stack([np.roll(r, k) for k in (-2, -1, 1, 2)])
    off = r - np.median(around, axis=0)
    off[:2] = r[:2] - np.median(r[:5])
    off[-2:] = r[-2:] - np.median(r[-5:])
    out[known] = off
    return out


def alike(residual: np.ndarray, kin: np.ndarray, finest: float) -> np.ndarray:
    """Mask (n,) of kin rows whose residuals (n,) are as far off their neighbours as their kin's.

    Where a joint has just arrived, all may be off what it then stays at.
    """
    off = distances(residual)
    known = kin & np.isfinite(off)
    if known.sum() < FEWEST_KIN:
        return np.zeros(len(residual), dtype=bool)
    return np.asarray(known & (np.abs(off) <= ISOLATED * max(robust_deviation(off[known]), finest)))


def returning(off: np.ndarray, repeats: Sequence[np.ndarray]) -> np.ndarray:
    """Mask (n,) of rows that stand off from others by `off` (n,) in most repeats of their step.

    That is what the mechanism does there, as at a stop that only the end of a stroke meets, and no
    mistake; two of three, or three of six, may be mistakes that met. repeats: row numbers
    (repeats, steps), -1 where a cycle lacks one.
    """
    out = np.zeros(len(off), dtype=bool)
    for rows in repeats:
        values = np.where(rows >= 0, off[rows], np.nan)
        count = np.isfinite(values).sum(axis=0)
        steps = count >= FEWEST_REPEATS
        usual = np.nanmedian(values[:, steps], axis=0)
        agree = np.sum(values[:, steps] * usual > RETURNS * usual**2, axis=0)
        agree = agree >= np.maximum(MOST * count[steps], FEWEST_REPEATS)
        again = values[:, steps] * usual > RETURNS * values[:, steps] ** 2
        out[rows[:, steps][again & agree]] = True
    return out


def at_commands(drive: np.ndarray, apart: float) -> np.ndarray:
    """Row numbers (most, k) of each command of a drive (n,) on either branch, -1 beyond its last.

    Commands less than `apart` [drive's unit] from each other are one.
    """
    level = np.floor((drive - drive.min()) / max(apart, 1e-300) + 0.5)
    _, kind, counts = np.unique(
        np.column_stack([level, branch_of(drive)]), axis=0, return_inverse=True, return_counts=True
    )
    kind = kind.ravel()
    order = np.argsort(kind, kind="stable")
    out = np.full((counts.max(), len(counts)), -1)
    out[np.arange(len(drive)) - np.repeat(np.cumsum(counts) - counts, counts), kind[order]] = order
    return out


def robust_deviation(values: np.ndarray) -> float:
    """Standard deviation of a Gaussian with the same median absolute deviation."""
    return float(1.4826 * np.median(np.abs(values - np.median(values)))) if len(values) else 0.0

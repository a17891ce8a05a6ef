"""Outliers: samples, alone or a few in a row, that stand off from those on both sides."""

from collections.abc import Sequence

import numpy as np

from pipeline.discrepancy.problem.spikes import NEIGHBOURS, off_both_sides
from pipeline.recording import branch_of

ISOLATED = 5.0
RETURNS, FEWEST_REPEATS = 0.5, 3
FEWEST_KIN = 4
LONGEST = 5
SUDDEN = 0.6


def isolated(
    residual: np.ndarray, train: np.ndarray, finest: float, repeats: Sequence[np.ndarray] = ()
) -> np.ndarray:
    """Mask (n,) of residuals that are off from their neighbours' median by ISOLATED deviations.

    residual: (n,), NaN where not measured. The deviation of that distance is learnt from `train`
    and is at least `finest`. Of a few in a row see `bursts`. What stands off in most `repeats` as
    well does not count, see `returning`.
    """
    off = distances(residual)
    known = np.isfinite(off)
    if not known.any():
        return known
    scale = max(robust_deviation(off[train & known]), finest)
    lone = known & (np.abs(off) > ISOLATED * scale) & ~returning(off, repeats)
    return np.asarray(lone | bursts(residual, train, finest, repeats))


def bursts(
    residual: np.ndarray, train: np.ndarray, finest: float, repeats: Sequence[np.ndarray] = ()
) -> np.ndarray:
    """Mask (n,) of residuals that are off in a row of 2 to LONGEST: the camera saw another thing.

    They stand off from what was before and after by ISOLATED deviations of such a distance, to one
    side, and get there and back at once: a corner, a jump that stays and a slow wave do not.
    """
    out = np.zeros(len(residual), dtype=bool)
    off, scale = heights(residual, train, finest)
    known = np.flatnonzero(np.isfinite(residual))
    side = np.where(np.abs(off[known]) > ISOLATED * scale, np.sign(off[known]), 0.0)
    step = np.abs(np.diff(residual[known], prepend=np.nan, append=np.nan))
    for run in np.split(np.arange(len(known)), np.flatnonzero(np.diff(side)) + 1):
        if not 1 < len(run) <= LONGEST or side[run[0]] == 0.0:
            continue
        height = float(np.min(np.abs(off[known[run]])))
        if min(step[run[0]], step[run[-1] + 1]) > SUDDEN * height:
            out[known[run]] = True
    return out & ~returning(off, repeats)


def heights(residual: np.ndarray, train: np.ndarray, finest: float) -> tuple[np.ndarray, float]:
    """How far residuals (n,) are off both what was before and what comes after, and its deviation.

    See `off_both_sides`: LONGEST in a row are none of the samples that each is compared with.
    """
    out = np.zeros(len(residual))
    known = np.flatnonzero(np.isfinite(residual))
    if len(known) < 2 * (LONGEST + NEIGHBOURS):
        return out, np.inf
    nearer, sides = off_both_sides(residual[known], LONGEST - 1)
    scale = max(robust_deviation(sides[:, train[known]].ravel()), finest)
    out[known] = nearer
    return out, scale


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
    mistake; two of three may be mistakes that met. repeats: row numbers (repeats, steps), -1 where
    a cycle lacks one.
    """
    out = np.zeros(len(off), dtype=bool)
    for rows in repeats:
        values = np.where(rows >= 0, off[rows], np.nan)
        steps = np.isfinite(values).sum(axis=0) >= FEWEST_REPEATS
        usual = np.nanmedian(values[:, steps], axis=0)
        agree = np.sum(values[:, steps] * usual > RETURNS * usual**2, axis=0) >= FEWEST_REPEATS
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

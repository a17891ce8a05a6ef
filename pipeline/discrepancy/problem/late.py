"""Late frames: samples that show the pose of some samples earlier, now and then or for a while."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import bdtrc

from pipeline.discrepancy.problem.outliers import (
    FEWEST_REPEATS,
    longest_burst,
    robust_deviation,
)

LATEST = 6
CREDIBLE, TURNS, SETTLED, SELDOM = 3.5, 60, 1e-3, 0.015
BY_CHANCE, NEARLY_ALL = 1e-4, 0.8
LEAST, MOST = 0.03, 0.45
EVIDENCE = 15.0
SPREAD = 2.0


def late_frames(
    measured: np.ndarray,
    predicted: np.ndarray,
    train: np.ndarray,
    finest: float,
    cycle: np.ndarray,
    repeats: Sequence[np.ndarray] = (),
) -> np.ndarray:
    """How many samples late each (n,) shows its pose: 0, or up to LATEST where it surely does.

    Whether frames are late at all is judged on `train`: of samples that agree with another pose
    than their own, as many would by chance agree with a later one as with an earlier one, which a
    late camera alone shows. Those in a row count once, and are no more than a burst has
    (`longest_burst`): a mechanism that stays behind does so for longer, or again in other cycles.
    Fewer than LEAST are the tail of the noise; so are any where that alone is about as likely.
    """
    nothing = np.zeros(len(measured), dtype=int)
    off = measured - predicted
    scale = max(robust_deviation(off[train & np.isfinite(off)]), finest)
    poses = poses_learnt(measured, predicted, train, scale, finest)
    late = poses.shown()
    if np.mean(late[train] > 0) < LEAST or poses.likelier() < EVIDENCE:
        return nothing
    back = poses_learnt(measured[::-1], predicted[::-1], train[::-1], scale, finest)
    ahead = back.shown()[::-1]
    longest = longest_burst(cycle)
    known = np.isfinite(off)
    short = (late > 0) & in_short_runs(late > 0, known, longest)
    if short[train].sum() < NEARLY_ALL * (late > 0)[train].sum() or again(short, repeats):
        return nothing
    before, after = runs(short & train, known & train), runs((ahead > 0) & train, known & train)
    if short[train & known].mean() > MOST or before < NEARLY_ALL * (before + after):
        return nothing
    if bdtrc(before - 1, before + after, 0.5) > BY_CHANCE:
        return nothing
    return np.where(short, late, 0)


@dataclass(frozen=True)
class Poses:
    """A mixture of Gaussians about the poses of up to LATEST samples before.

    shares: (LATEST + 1,) of samples that show each. shift: what part of a sample all poses are
    late: a fit has taken that much for a lag. scale: their spread. error: (LATEST + 1, n) of the
    measurement from each pose. step: (n,) from the pose before. train: (n,) mask of its samples.
    """

    shares: np.ndarray
    shift: float
    scale: float
    error: np.ndarray
    step: np.ndarray
    train: np.ndarray

    @property
    def left(self) -> np.ndarray:
        """What each pose leaves of each sample, (LATEST + 1, n)."""
        return self.error - self.shift * self.step

    @property
    def near(self) -> np.ndarray:
        """Mask (n,) of samples near one of the poses; others were mistaken, no matter when."""
        away = np.abs(self.left)
        nearest = away.min(axis=0, initial=np.inf, where=np.isfinite(away))
        return nearest < CREDIBLE * self.scale

    def weights(self, rows: np.ndarray) -> np.ndarray:
        """Shares times densities at some rows, without 1 / sqrt(2 pi), (LATEST + 1, rows)."""
        away = self.left[:, rows] / self.scale
        return self.shares[:, None] * np.exp(-0.5 * away**2) / self.scale

    def likelier(self) -> float:
        """-2 log likelihood of one Gaussian about the pose itself, less that of the mixture."""
        rows = self.near & self.train
        error, step = self.error[0, rows], self.step[rows]
        slope = float(error @ step) / max(float(step @ step), 1e-300)
        alone = np.log(max(float(np.mean((error - slope * step) ** 2)), 1e-300)) + 1.0
        return float(len(error) * alone + 2.0 * np.sum(np.log(self.weights(rows).sum(axis=0))))

    def shown(self) -> np.ndarray:
        """How many samples before (n,) the likeliest pose of each is, from 0 to LATEST."""
        rows = np.flatnonzero(self.near)
        joint = self.weights(rows)
        out = np.zeros(len(self.step), dtype=int)
        late = joint[0] < 0.5 * joint.sum(axis=0)
        out[rows] = np.where(late, 1 + np.argmax(joint[1:], axis=0), 0)
        return out


def poses_learnt(
    measured: np.ndarray, predicted: np.ndarray, train: np.ndarray, scale: float, finest: float
) -> Poses:
    """The mixture that suits the samples of `train` best, begun at a spread of `scale`.

    By expectation and maximisation (Dempster et al., J. R. Stat. Soc. B 39 (1977) 1).
    """
    rows = np.maximum(np.arange(len(measured)) - np.arange(LATEST + 1)[:, None], 0)
    shares = np.full(LATEST + 1, 0.5 / LATEST)
    shares[0] = 0.5
    step = np.diff(predicted, prepend=predicted[:1])
    poses = Poses(shares, 0.0, scale, measured - predicted[rows], step, train)
    for _ in range(TURNS):
        learnt = poses.near & train
        joint = poses.weights(np.flatnonzero(learnt))
        weight = joint / joint.sum(axis=0)
        last, shares = poses.shares, np.mean(weight, axis=1)
        if shares[0] > 1.0 - SELDOM or np.max(np.abs(shares - last)) < SETTLED:
            return replace(poses, shares=shares)
        moved, error = step[learnt], poses.error[:, learnt]
        shift = float(np.sum(weight * error * moved) / max(np.sum(moved**2), 1e-300))
        spread = np.sum(weight * (error - shift * moved) ** 2, axis=0)
        scale = max(float(np.sqrt(np.mean(spread))), finest)
        poses = replace(poses, shares=shares, shift=shift, scale=scale)
    return poses


def again(some: np.ndarray, repeats: Sequence[np.ndarray]) -> bool:
    """Whether some samples (n,) are so at the same steps of cycles that repeat each other.

    Then their counts at each step differ by more than those of as many independent samples, whose
    variance is the binomial one. repeats: row numbers (repeats, steps), -1 where a cycle lacks one.
    """
    for rows in repeats:
        known = rows >= 0
        known &= known.sum(axis=0) >= FEWEST_REPEATS
        of, count = known.sum(axis=0), (some[rows] & known).sum(axis=0)
        share = count.sum() / max(of.sum(), 1)
        by_chance = np.sum(of) * share * (1.0 - share)
        if np.sum((count - share * of) ** 2) > SPREAD * by_chance:
            return True
    return False


def in_short_runs(some: np.ndarray, known: np.ndarray, longest: int) -> np.ndarray:
    """Mask (n,) of samples that are no more than `longest` in a row, where known (n,)."""
    out = np.zeros(len(some), dtype=bool)
    rows = np.flatnonzero(known)
    for run in np.split(rows, np.flatnonzero(np.diff(some[rows].astype(int))) + 1):
        out[run] = len(run) <= longest
    return out


def runs(some: np.ndarray, known: np.ndarray) -> int:
    """How many rows of samples that follow each other are some (n,), where known (n,)."""
    return int(np.sum(np.diff(some[known].astype(int), prepend=0) > 0))

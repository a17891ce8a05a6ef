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
BEGUN, FEW_ROWS, FEW_TURNS = (0.0, 0.4, 0.8), 300, 15
BY_CHANCE, NEARLY_ALL = 1e-4, 0.8
LEAST, MOST, MOST_UNSURE = 0.03, 0.6, 0.7
EVIDENCE, OVERWHELMING, SEEN = 15.0, 150.0, 0.2
SPREAD = 2.0
WIDE, WIDER = 0.1, 2.0
SURELY, NO_MATTER, FRESH = 0.9, 0.5, 0.1


@dataclass(frozen=True)
class LateFrames:
    """late: (n,) how many samples later than the usual ones each shows its pose; negative: earlier.

    unsure: (n,) mask of those of which nobody can say, though it matters there.
    """

    late: np.ndarray
    unsure: np.ndarray

    @property
    def aside(self) -> np.ndarray:
        """Mask (n,) of the samples that do not surely show the usual pose."""
        return (self.late != 0) | self.unsure

    def since(self, rows: np.ndarray) -> np.ndarray:
        """How late those of some rows are that are sure, if those of the latest pose are not."""
        late = self.late[rows & ~self.unsure]
        return np.asarray(late - late.min(initial=0))


def none_late(count: int) -> LateFrames:
    """Of so many samples each shows the usual pose."""
    return LateFrames(np.zeros(count, dtype=int), np.zeros(count, dtype=bool))


def late_frames(
    measured: np.ndarray,
    predicted: np.ndarray,
    train: np.ndarray,
    finest: float,
    cycle: np.ndarray,
    repeats: Sequence[np.ndarray] = (),
) -> LateFrames:
    """Which samples surely show an earlier pose than the usual ones, or a later one.

    Whether frames are late at all is judged on `train`. Those in a row are no more than a burst has
    (`longest_burst`), or than chance makes of so many: a mechanism that stays behind does so for
    longer, or again in other cycles. Fewer than LEAST are the tail of the noise; so are any where
    that alone is about as likely, or hardly any step exceeds it; and as many would by chance agree
    with a later pose as with an earlier one (`as_often_ahead`), unless the evidence is OVERWHELMING
    and hardly any stand off where no pose is.
    """
    nothing = none_late(len(measured))
    judged = train & np.isfinite(measured - predicted)
    if not judged.any():
        return nothing
    poses = poses_learnt(measured, predicted, judged, finest)
    told, evidence = poses.told(), poses.likelier()
    odd = told.late != 0
    share = float(np.mean(odd[judged]))
    seen = judged & (np.abs(poses.step) > poses.scale)
    if not LEAST <= share <= MOST or evidence < EVIDENCE or seen.sum() < SEEN * judged.sum():
        return nothing
    longest = max(longest_burst(cycle), longest_by_chance(share, int(judged.sum())))
    short = odd & in_short_runs(odd, np.isfinite(measured - predicted), longest)
    if short[train].sum() < NEARLY_ALL * odd[train].sum():
        return nothing
    if again(short, repeats, poses.matters) or told.aside[judged].mean() > MOST_UNSURE:
        return nothing
    stray = int(np.sum(judged & ~poses.near))
    clear = odd[judged].sum() > NEARLY_ALL * (odd[judged].sum() + stray)
    if not (clear and evidence > OVERWHELMING):
        back = poses_learnt(measured[::-1], predicted[::-1], judged[::-1], finest)
        if as_often_ahead(short & judged, back.told().late[::-1] != 0, judged):
            return nothing
    return LateFrames(np.where(short, told.late, 0), told.unsure | (odd & ~short))


def as_often_ahead(late: np.ndarray, ahead: np.ndarray, judged: np.ndarray) -> bool:
    """Whether about as many samples show a later pose, as by chance they would, as an earlier one.

    Masks (n,) of these, and of those judged. Some in a row count once.
    """
    before, after = runs(late, judged), runs(ahead & judged, judged)
    few = before < NEARLY_ALL * (before + after)
    return few or bool(bdtrc(before - 1, before + after, 0.5) > BY_CHANCE)


def longest_by_chance(share: float, count: int) -> int:
    """How many in a row a share of `count` samples that are drawn by lot hardly exceeds."""
    return int(np.ceil(np.log(BY_CHANCE / count) / np.log(share)))


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
        """-2 log likelihood of errors about the pose itself, less that of the mixture."""
        rows = self.near & self.train
        if not rows.any():
            return -np.inf
        error, step = self.error[0, rows], self.step[rows]
        slope = float(error @ step) / max(float(step @ step), 1e-300)
        alone = cost_of_errors((error - slope * step) ** 2)
        return alone + float(2.0 * np.sum(np.log(self.weights(rows).sum(axis=0))))

    @property
    def fresh(self) -> bool:
        """Whether it says more than that frames, late as a rule, are fresh once in a while.

        Those are mistakes: to either side as often.
        """
        before = self.shares[: int(np.argmax(self.shares))]
        return len(before) == 0 or float(before.sum()) > FRESH

    @property
    def matters(self) -> np.ndarray:
        """Mask (n,) of samples a step before which is no matter of noise."""
        return np.abs(self.step) > NO_MATTER * self.scale

    def told(self) -> LateFrames:
        """The likeliest pose of each sample, from the usual one on, and whether it surely is."""
        rows, usual = np.flatnonzero(self.near), int(np.argmax(self.shares))
        joint = self.weights(rows)
        every, own = joint.sum(axis=0), joint[usual]
        joint[usual] = np.where(own < 0.5 * every, 0.0, np.inf)
        late, unsure = np.zeros(len(self.step), dtype=int), np.zeros(len(self.step), dtype=bool)
        late[rows] = np.argmax(joint, axis=0) - usual
        unsure[rows] = (late[rows] == 0) & (own < SURELY * every)
        return LateFrames(late, unsure & self.matters)


def cost_of_errors(squares: np.ndarray) -> float:
    """-2 log likelihood, but for 1 / sqrt(2 pi), of errors whose squares (n,) are known.

    Of two Gaussians, the wider one of those that were mistaken (Tukey, Contributions to Probability
    and Statistics (1960) 448), by a few turns of expectation and maximisation.
    """
    shares = np.array([1.0 - WIDE, WIDE])
    scales = max(float(np.mean(squares)), 1e-300) * np.array([1.0, WIDER**2])
    for _ in range(FEW_TURNS):
        joint = shares / np.sqrt(scales) * np.exp(-0.5 * squares[:, None] / scales)
        weight = joint / np.maximum(joint.sum(axis=1, keepdims=True), 1e-300)
        shares = np.maximum(weight.mean(axis=0), 1e-12)
        scales = np.maximum(squares @ weight / np.maximum(weight.sum(axis=0), 1e-300), 1e-300)
    joint = shares / np.sqrt(scales) * np.exp(-0.5 * squares[:, None] / scales)
    return float(-2.0 * np.sum(np.log(np.maximum(joint.sum(axis=1), 1e-300))))


def poses_learnt(
    measured: np.ndarray, predicted: np.ndarray, judged: np.ndarray, finest: float
) -> Poses:
    """The mixture that suits the samples `judged`, a mask (n,), best.

    Begun at several shifts, each tried on some of the samples: a fit may have taken the mean of all
    poses for a lag, and then half of a pose is no step away from all of it.
    """
    scale = max(robust_deviation((measured - predicted)[judged]), finest)
    rows = np.maximum(np.arange(len(measured)) - np.arange(LATEST + 1)[:, None], 0)
    step = np.diff(predicted, prepend=predicted[:1])
    error = measured - predicted[rows]
    shares = np.full(LATEST + 1, 0.5 / LATEST)
    shares[0] = 0.5
    some = np.flatnonzero(judged)[:: max(int(judged.sum()) // FEW_ROWS, 1)]
    every = np.ones(len(some), dtype=bool)
    begun = [
        learnt(Poses(shares, shift, scale, error[:, some], step[some], every), finest, FEW_TURNS)
        for shift in BEGUN
    ]
    best = max(begun, key=lambda p: p.likelier() if p.fresh else -np.inf)
    return learnt(replace(best, error=error, step=step, train=judged), finest, TURNS)


def learnt(poses: Poses, finest: float, turns: int) -> Poses:
    """A mixture after some turns, or fewer where it stands still.

    By expectation and maximisation (Dempster et al., J. R. Stat. Soc. B 39 (1977) 1).
    """
    for _ in range(turns):
        near = poses.near & poses.train
        if not near.any():
            return poses
        joint = poses.weights(np.flatnonzero(near))
        weight = joint / np.maximum(joint.sum(axis=0), 1e-300)
        last, shares = poses.shares, np.mean(weight, axis=1)
        if shares[0] > 1.0 - SELDOM or np.max(np.abs(shares - last)) < SETTLED:
            return replace(poses, shares=shares)
        moved, error = poses.step[near], poses.error[:, near]
        shift = float(np.sum(weight * error * moved) / max(np.sum(moved**2), 1e-300))
        spread = np.sum(weight * (error - shift * moved) ** 2, axis=0)
        scale = max(float(np.sqrt(np.mean(spread))), finest)
        poses = replace(poses, shares=shares, shift=shift, scale=scale)
    return poses


def again(some: np.ndarray, repeats: Sequence[np.ndarray], judged: np.ndarray) -> bool:
    """Whether some samples (n,) are so at the same steps of cycles that repeat each other.

    Of those alone that can be judged (n,). Then their counts at each step differ by more than those
    of as many independent samples, whose variance is the binomial one. repeats: row numbers
    (repeats, steps), -1 where a cycle lacks one.
    """
    for rows in repeats:
        known = (rows >= 0) & judged[rows]
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

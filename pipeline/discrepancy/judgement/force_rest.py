"""Signs that what a law of force leaves is no noise, though the noise that was learnt says so."""

import numpy as np
from scipy.special import chdtrc

from pipeline.discrepancy.noise.force_noise import spell_of
from pipeline.discrepancy.problem.travelled import travelled
from pipeline.discrepancy.search.weighing import Choice
from pipeline.recording import reversals_of

FEWEST_BENDS = 40
NEGLIGIBLE = 1e-3
FEWEST_NEAR, EARLY, MORE = 20, 0.2, 2.0


def too_slow(choice: Choice, correlation: float) -> bool:
    """Whether a force's residual bends from row to row less than noise that is correlated so.

    Neighbours of noise that is correlated by c bend by 6 - 8 c + 2 c^2 of its variance (variance of
    the second difference). The noise that was learnt of a force does not tell: it is what a law
    leaves that is no more than flexible, any slow rest with it.
    """
    left = left_by(choice)
    bends = np.diff(left, 2)
    bends = bends[np.isfinite(bends)]
    least = 6.0 - 8.0 * correlation + 2.0 * correlation**2
    return len(bends) >= FEWEST_BENDS and float(np.mean(bends**2)) < least * mean_square(left)


def after_reversals(choice: Choice) -> bool:
    """Whether most of a force's residual is after reversals, and much more than elsewhere.

    After a reversal: in the first EARLY of a usual stroke; much more: MORE times its mean square.
    Noise knows of no reversals: where the form was right, that was at most 1.5 times as much.
    """
    left, drive = left_by(choice), choice.fit.ground.problem.motion.drive
    turns = reversals_of(drive)
    if len(turns) < 2:
        return False
    stroke = float(np.median(np.abs(np.diff(drive[turns]))))
    known, early = np.isfinite(left), travelled(drive) < EARLY * stroke
    near, far = left[known & early], left[known & ~early]
    if min(len(near), len(far)) < FEWEST_NEAR:
        return False
    most = float(near @ near) > float(far @ far)
    return most and mean_square(near) > MORE * mean_square(far)


def changing(choice: Choice) -> tuple[float, float]:
    """How much of what a law of force leaves is its change with time, and how likely by chance.

    A share of the innovations' squares: what resists by speed and direction and what springs,
    growing or falling with the time (what goes by the speed also with its square), beside all that
    the law itself can follow. Neighbours of the others that say the same count once in the chance.
    """
    fit, ground = choice.fit, choice.fit.ground
    motion, used = ground.problem.motion, ground.used
    assert motion.kinetics is not None
    speed, drive = motion.kinetics.velocity, motion.drive - np.mean(motion.drive[used])
    time = 2.0 * (motion.time_s - motion.time_s[0]) / np.ptp(motion.time_s) - 1.0
    changes = (speed * time, speed * time**2, np.sign(speed) * time, drive * time)
    columns = ground.whiten(np.where(used[:, None], np.column_stack(changes), 0.0))
    columns = columns - fit.basis @ (fit.basis.T @ columns)
    sizes = np.maximum(np.linalg.norm(columns, axis=0), 1e-300)
    basis, kept, _ = np.linalg.svd(columns / sizes, full_matrices=False)
    basis = basis[:, kept > NEGLIGIBLE]
    rest = fit.innovations
    other = rest - basis @ (basis.T @ rest)
    share = 1.0 - float(other @ other) / max(float(rest @ rest), 1e-300)
    apart = len(rest) / spell_of(other, np.flatnonzero(used))
    return share, float(chdtrc(max(basis.shape[1], 1), share * apart))


def left_by(choice: Choice) -> np.ndarray:
    """The residual of a choice on the rows fitted, (n,), NaN elsewhere."""
    ground = choice.fit.ground
    return np.where(ground.used, ground.problem.measured - choice.fit.predicted, np.nan)


def mean_square(values: np.ndarray) -> float:
    """Mean square of those that are known."""
    return float(np.nanmean(values**2))

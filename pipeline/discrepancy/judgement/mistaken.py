"""Mistaken or stale frames: are the outliers more than noise would give, and how large are they?"""

from collections.abc import Container

import numpy as np
from scipy.optimize import minimize
from scipy.special import pdtrc, stdtr

from pipeline.discrepancy.judgement.cycle_zero import about_each_zero
from pipeline.discrepancy.judgement.loudness import loudness
from pipeline.discrepancy.judgement.slipping import slipping
from pipeline.discrepancy.judgement.turned_between import turned_between
from pipeline.discrepancy.model.intervals import undated
from pipeline.discrepancy.model.result import Estimate, Evidence, NamedPhysics, root_mean
from pipeline.discrepancy.problem.late import LateFrames
from pipeline.discrepancy.problem.problem import Problem
from pipeline.discrepancy.problem.travelled import travelled
from pipeline.discrepancy.search.counted import INCREDIBLE, late_rows, repeats_of
from pipeline.discrepancy.search.explain import Explanation
from pipeline.discrepancy.search.weighing import Choice
from pipeline.number_words import worded
from pipeline.physics.catalogue import term
from pipeline.physics.frame_lag import FrameLag
from pipeline.physics.held import STEP_AND_WAIT_S
from pipeline.physics.saw_ripple import SawRipple

FRAME_LAG = FrameLag.name
FEWEST, FEWEST_FAR = 3, 2
CREDIBLE, NEARLY_ALL = 3.0, 0.8
FAR = 10.0
MOST_MISTAKEN = 0.1
LATELY = 16
BY_CHANCE = 1e-3
HEAVY, LIGHT = 3.0, 8.0
ROUNDED_BY = 1.5
Z, SURELY = 1.96, 0.97
AGAIN = "In {share:.2g} of the samples the sensor says again what it said in the one before."
STALE = (
    "In {share:.2g} of the frames the camera shows the pose of the frame before: "
    "they are {size} {unit} off."
)
LATE = "In {share:.2g} of the frames the camera shows an earlier pose, {lag} frames late."


def mistaken_frames(
    explanation: Explanation, evidence: Evidence, taken: Container[str], unexplained: bool
) -> NamedPhysics | None:
    """Frames that are mistaken, or stale where no name taken says so.

    None where too few are, or so many that a sensor which mistakes them would be none.

    unexplained: whether a structured rest is left: of that a few samples stand off as well, but by
    less than FAR times the noise, or after steps of other lengths or sooner after reversals than
    the rest. None either where they come after waits of other lengths, or beside an old frame
    nearly all lie between two poses: then they show what was still on its way. Nor where noise with
    heavy tails throws some as far, nor where the drive turned between two samples.
    """
    found = share_and_size(explanation)
    if found is None or found[0].value > MOST_MISTAKEN or of_heavy_tails(explanation):
        return None
    noise = explanation.choices[0].fit.ground.noise.deviation
    few = alone(incredible(explanation)) < FEWEST
    motion = explanation.problem.motion
    if unexplained and (few or found[1].value < FAR * noise or follow_the_drive(explanation)):
        return None
    waits = np.diff(motion.time_s)
    if after_some(waits, explanation) or on_their_way(explanation) or at_unseen_turns(explanation):
        return None
    name = FRAME_LAG if stale(explanation) else "marker_outliers"
    if name in taken:
        return None
    off, heldout = evidence.measured - evidence.after, evidence.heldout
    return NamedPhysics(
        name=name,
        site="sensor",
        probability=SURELY,
        parameters=found,
        heldout_rmse_without=root_mean((off**2)[np.isfinite(off) & heldout]),
        alternatives=(),
        says=said_of(name, found, explanation.problem),
    )


def at_unseen_turns(explanation: Explanation) -> bool:
    """Whether such rows stand off outwards, where a drive that runs on turned between samples."""
    problem = explanation.problem
    if problem.around.dwell_s >= STEP_AND_WAIT_S:
        return False
    off, drive = errors_of(explanation), problem.motion.drive
    along = off * float(np.sign(problem.curve.slope))
    return turned_between(drive, along, incredible(explanation), problem.train)


def of_heavy_tails(explanation: Explanation) -> bool:
    """Whether noise with the tails of the other rows throws as many of them as far as these are.

    Student's t says how many, where the other rows are surely no Gaussian's. Those that are
    mistaken were left out of them: they are a sample that is cut off (`tails_of`). Readings in
    levels are peaked, but none is off by much more than half a step.
    """
    fit, levels = explanation.choices[0].fit, explanation.problem.levels
    far = np.abs(errors_of(explanation))[incredible(explanation)]
    if explanation.problem.read is not None and levels and far.min() > ROUNDED_BY * levels.step:
        return False
    others = fit.innovations / np.std(fit.innovations)
    return thrown_as_far(far / fit.ground.noise.deviation, others)


def thrown_as_far(off: np.ndarray, others: np.ndarray) -> bool:
    """Whether noise with the tails of others throws as many of them as far as some are off.

    off: (k,) distances, others: (n,) errors, both in deviations of these.
    """
    freedom, scale = tails_of(others, float(off.min()))
    expected = 2.0 * len(others) * stdtr(freedom, -off.min() / scale)
    return bool(pdtrc(len(off) - 1, expected) > BY_CHANCE)


def tails_of(values: np.ndarray, most: float) -> tuple[float, float]:
    """Degrees of freedom and scale of Student's t of values (n,) of which none is beyond `most`.

    Maximum likelihood of the distribution cut off there; infinite where a Gaussian, cut off so,
    is hardly less likely (HEAVY deviations).
    """
    from scipy.stats import t  # 0.3 s: only mistaken frames wait for it

    kept = values[np.abs(values) < most]

    def cost(log_freedom: float, log_scale: float) -> float:
        freedom, scale = np.exp(min(log_freedom, LIGHT)), np.exp(log_scale)
        within = np.log1p(-2.0 * t.cdf(-most, freedom, scale=scale))
        return float(-2.0 * np.sum(t.logpdf(kept, freedom, scale=scale) - within))

    light = minimize(lambda x: cost(LIGHT, x[0]), [0.0], method="Nelder-Mead")
    heavy = minimize(lambda x: cost(*x), [2.0, -0.1], method="Nelder-Mead")
    if heavy.fun > light.fun - HEAVY**2:
        return np.inf, 1.0
    return float(np.exp(heavy.x[0])), float(np.exp(heavy.x[1]))


def share_and_size(explanation: Explanation) -> tuple[Estimate, Estimate] | None:
    """Share and size of the outliers with 95 % intervals, or None where there are too few.

    Judged on training rows that the noise does not make credible; neighbours count once, and those
    between which a slip may lie not at all. Of those that are off by more than FAR times the noise
    fewer will do. The share's interval is Wilson's, the size's that of a mean.
    """
    problem, fit = explanation.problem, explanation.choices[0].fit
    rows = incredible(explanation)
    count, n = int(rows.sum()), int(problem.train.sum())
    every = np.abs(errors_of(explanation))
    far = rows & (every > FAR * fit.ground.noise.deviation)
    if alone(rows) < FEWEST and alone(far) < FEWEST_FAR:
        return None
    return share_of(count, n), size_of(every[rows], problem.around.angle_unit)


def size_of(off: np.ndarray, unit: str) -> Estimate:
    """The mean of some distances (k,) [unit], with its interval."""
    size = float(np.mean(off))
    error = Z * float(np.std(off, ddof=1)) / np.sqrt(len(off))
    return Estimate("size", size, max(size - error, 0.0), size + error, unit)


def alone(rows: np.ndarray) -> int:
    """How many of some rows (n,) there are, neighbours counted once."""
    return int(np.sum(np.diff(np.flatnonzero(rows), prepend=-9) > 1))


def share_of(count: int, n: int) -> Estimate:
    """A share of n with Wilson's interval."""
    middle = (count + 0.5 * Z**2) / (n + Z**2)
    reach = Z / (n + Z**2) * np.sqrt(count * (n - count) / n + 0.25 * Z**2)
    return Estimate("share", count / n, max(middle - reach, 0.0), middle + reach, "")


def stale_now_and_then(problem: Problem, evidence: Evidence) -> NamedPhysics | None:
    """Samples that repeat the one before without a rhythm, so that it is no slower sensor's."""
    if problem.stale.even:
        return None
    came = evidence.recording.values(evidence.measurement)
    known, new = np.isfinite(came), np.isfinite(evidence.measured)
    share = share_of(int(np.sum(known & ~new)), int(known.sum()))
    last = np.maximum.accumulate(np.where(new, np.arange(len(new)), 0))
    held = known & evidence.heldout[last]
    return NamedPhysics(
        name=FRAME_LAG,
        site="sensor",
        probability=SURELY,
        parameters=(share,),
        heldout_rmse_without=float(np.sqrt(np.mean((came - evidence.after)[held] ** 2))),
        alternatives=(),
        says=AGAIN.format(share=share.value),
    )


def late_now_and_then(explanation: Explanation, evidence: Evidence) -> NamedPhysics | None:
    """Frames of an earlier pose among others that are none, with their share and how late."""
    found = late_by(explanation, explanation.choices[0])
    train = explanation.problem.train
    if not found.late[train].any():
        return None
    by = found.since(train)
    late = by[by > 0]
    error = Z * float(np.std(late)) / np.sqrt(len(late))
    share = share_of(len(late), len(by))
    lag = Estimate("lag", float(late.mean()), late.mean() - error, late.mean() + error, "frames")
    off, heldout = evidence.measured - evidence.after, evidence.heldout
    return NamedPhysics(
        name=FRAME_LAG,
        site="sensor",
        probability=SURELY,
        parameters=(share, lag),
        heldout_rmse_without=root_mean((off**2)[np.isfinite(off) & heldout]),
        alternatives=(),
        says=LATE.format(share=share.value, lag=worded(lag.value)),
    )


def late_by(explanation: Explanation, choice: Choice) -> LateFrames:
    """Which rows show another pose than the usual ones of a choice."""
    problem, prior = explanation.problem, explanation.prior
    predicted = choice.fit.predicted + explanation.zero
    return late_rows(problem, predicted, prior, repeats_of(problem, prior))


def incredible(explanation: Explanation) -> np.ndarray:
    """Training rows (n,) that are off by more than the noise at their angle makes credible.

    Those while a shaft slips, those of an earlier pose and those at the edge of a stair are none,
    nor the first ones: how a mechanism lay before the recording shows there.
    """
    problem, fit = explanation.problem, explanation.choices[0].fit
    rows = problem.train & explanation.outliers & ~undated(fit, problem.motion.time_s)
    rows &= ~late_by(explanation, explanation.choices[0]).aside
    off = errors_of(explanation)
    rows &= ~slipping(problem, explanation.choices[0], off)
    for piece in fit.pieces:
        if isinstance(piece.term, SawRipple):
            rows &= ~piece.term.at_edge(problem.motion.drive, piece.values)
    usual = fit.ground.noise.deviation * loudness(off, fit.predicted, problem.train)
    rows &= np.abs(off) > INCREDIBLE * usual
    return np.asarray(rows & (np.cumsum(problem.train & ~rows) > 0))


def errors_of(explanation: Explanation) -> np.ndarray:
    """What the best choice leaves of each row, (n,), about each cycle's zero where that jitters."""
    problem, fit = explanation.problem, explanation.choices[0].fit
    off = problem.measured - fit.predicted - explanation.zero
    if fit.ground.noise.jitter == 0.0:
        return off
    return about_each_zero(off, problem.cycle, explanation.used & np.isfinite(off))


def follow_the_drive(explanation: Explanation) -> bool:
    """Whether such rows come after other steps, or sooner after reversals, than the rest."""
    travel = travelled(explanation.problem.motion.drive)[1:]
    return after_other_steps(explanation) < BY_CHANCE or after_some(travel, explanation)


def after_some(lengths: np.ndarray, explanation: Explanation) -> bool:
    """Whether such rows come after steps or waits of other lengths (n - 1,) than the rest."""
    return unlike_rest(lengths, explanation, incredible(explanation)) < BY_CHANCE


def after_other_steps(explanation: Explanation) -> float:
    """How likely such rows come by chance after steps as much unlike the rest's.

    After the last one, or the largest of the LATELY last: what a jump of the drive sets swinging
    goes on for a while. Of rows that follow each other at once the first says that.
    """
    steps, rows = np.abs(np.diff(explanation.problem.motion.drive)), incredible(explanation)
    before = np.concatenate([np.zeros(LATELY - 1), steps])
    largest = np.lib.stride_tricks.sliding_window_view(before, LATELY).max(axis=1)
    first = rows & ~np.concatenate([[False], rows[:-1]])
    return min(
        1.0,
        2.0 * unlike_rest(steps, explanation, rows),
        2.0 * unlike_rest(largest, explanation, first),
    )


def unlike_rest(lengths: np.ndarray, explanation: Explanation, rows: np.ndarray) -> float:
    """How likely mistaken rows (n,) come after lengths (n - 1,) as much unlike the rest by chance.

    A camera mistakes a marker whatever came before; a joint that still rings does not, nor one
    that an old frame shows on its way (Kolmogorov-Smirnov). 1 where there are none.
    """
    if not rows[1:].any():
        return 1.0
    from scipy.stats import ks_2samp  # 0.3 s: only mistaken frames wait for it

    rest = explanation.problem.train & ~incredible(explanation)
    return float(ks_2samp(lengths[rows[1:]], lengths[rest[1:]]).pvalue)


def on_their_way(explanation: Explanation) -> bool:
    """Whether nearly all such rows, beside an old frame, lie between two poses."""
    fit, rows = explanation.choices[0].fit, np.flatnonzero(incredible(explanation))
    if FRAME_LAG not in fit.names:
        return False
    back = fit.predicted[rows - 1] - fit.predicted[rows]
    share = errors_of(explanation)[rows] / np.where(back == 0.0, np.inf, back)
    return bool(np.mean((share > 0.0) & (share < 1.0)) > NEARLY_ALL)


def stale(explanation: Explanation) -> bool:
    """Whether mistaken frames are nearly all what the frame before them should have shown."""
    problem, fit = explanation.problem, explanation.choices[0].fit
    rows = np.flatnonzero(incredible(explanation))
    off = np.abs(problem.measured[rows] - fit.predicted[rows - 1])
    return bool(np.mean(off < CREDIBLE * fit.ground.noise.deviation) > NEARLY_ALL)


def said_of(name: str, found: tuple[Estimate, Estimate], problem: Problem) -> str:
    """One line for a mechanic on mistaken or, as `frame_lag`, stale frames."""
    share, size = (e.value for e in found)
    if name == FRAME_LAG:
        return STALE.format(share=share, size=worded(size), unit=problem.around.angle_unit)
    return term(name).sentence(np.array([share, size]), problem.around)

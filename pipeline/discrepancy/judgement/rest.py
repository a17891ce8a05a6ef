"""The structured rest: what flexible curves still find in a residual that no term explains."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.polynomial import legendre
from scipy.special import chdtrc

from pipeline.discrepancy.fitting.fit import Fit, evaluate
from pipeline.discrepancy.fitting.ground import Ground
from pipeline.discrepancy.noise.family import NoiseFamily, Place
from pipeline.discrepancy.noise.hats import hats
from pipeline.discrepancy.noise.learning import NoisePrior
from pipeline.discrepancy.noise.noise import NoiseModel
from pipeline.discrepancy.problem.problem import Problem
from pipeline.discrepancy.problem.travelled import travelled
from pipeline.discrepancy.search.refuted import in_common, steps_again
from pipeline.discrepancy.search.weighing import Choice
from pipeline.recording import branch_of

FINE, COARSE, TRAVELS, SLOW = 24, 5, 12, 3
EVERY_OTHER, CYCLE = "every other cycle", "the cycle"
GAIN_OF_CYCLE, GAIN_IN_TIME = "the gain in each cycle", "the gain, which changes with time"
CHANGING = frozenset((EVERY_OTHER, CYCLE, GAIN_OF_CYCLE, GAIN_IN_TIME))
STIFFENING = 1e-3
DOUBTED, DRAWS = 1e-3, 12
UNIFORM, HUMPS = 1.8, 4.0


@dataclass(frozen=True)
class Rest:
    """What one family of curves finds: fall of the cost, its degrees of freedom, and its size.

    size: root mean square [measurement's unit] of the structure, were the noise white, beyond what
    chance gives.
    """

    where: str
    gain: float
    freedom: int
    p_value: float
    size: float


@dataclass(frozen=True)
class Flexible:
    """Curves beside all that a fit can follow: columns (n, k), the same whitened (count, k)."""

    columns: np.ndarray
    white: np.ndarray

    @property
    def freedom(self) -> int:
        return self.white.shape[1]

    def without(self, residual: np.ndarray, innovations: np.ndarray) -> np.ndarray:
        """A residual (n,), whitened (count,), less what the curves explain of it."""
        normal = self.white.T @ self.white
        normal += STIFFENING * np.trace(normal) / max(len(normal), 1) * np.eye(len(normal))
        weights = np.linalg.solve(normal, self.white.T @ innovations)
        return np.asarray(residual - self.columns @ weights)


def structured_rest(choice: Choice, family: NoiseFamily) -> list[Rest]:
    """What each family of flexible curves finds in a choice's residual, the surest first.

    Calibration, terms (to first order) and noise are refitted beside the curves. Noise that is
    refitted gains by itself where it is correlated or jitters, the more curves there are: a gain
    that would be DOUBTED otherwise is divided by how many times its freedom such noise alone gains
    (Bartlett's correction by the bootstrap, Rocke, J. Am. Stat. Assoc. 84 (1989) 598; of an angle).
    """
    fit = choice.fit
    problem, ground = fit.ground.problem, fit.ground
    residual = np.where(ground.used, problem.measured - fit.predicted, 0.0)
    cost = family.weigh(choice.place, residual)[0]
    taken = followed(fit)
    own = np.linalg.pinv(ground.whiten(taken))
    out = []
    for where, columns in curves(problem).items():
        flexible = _beside(columns, ground, taken, own)
        freedom, innovations = flexible.freedom, fit.innovations
        gain = _gain(flexible, residual, innovations, choice.place, family, cost)
        if problem.derivatives is None and chdtrc(freedom, gain) < DOUBTED:
            gain /= max(_by_noise(flexible, choice, family, taken, own), 1.0)
        count = ground.count / ground.noise.spell
        size = ground.noise.deviation * float(np.sqrt(max(gain - freedom, 0.0) / count))
        out.append(Rest(where, gain, freedom, float(chdtrc(freedom, gain)), size))
    return sorted(out, key=lambda r: r.p_value)


def _gain(
    flexible: Flexible,
    residual: np.ndarray,
    innovations: np.ndarray,
    place: Place,
    family: NoiseFamily,
    cost: float,
) -> float:
    """By how much less than `cost` a residual's likelihood costs without what curves explain."""
    rest = flexible.without(residual, innovations)
    return max(cost - family.weigh(family.pick(rest, place)[1], rest)[0], 0.0)


def _by_noise(
    flexible: Flexible, choice: Choice, family: NoiseFamily, taken: np.ndarray, own: np.ndarray
) -> float:
    """How many times their freedom curves gain on the mean of DRAWS of noise.

    As it was learnt where cycles repeat, else as the choice has it, which may hold some of the
    structure; without a walk, which may be all of that.
    """
    ground, rng, prior = choice.fit.ground, np.random.default_rng(0), family.prior
    motion = ground.problem.motion
    steady, begun = replace(ground.noise, walk=0.0), (*choice.place[:2], 0)
    if prior.repeats > 0:
        steady, begun = replace(prior.model, walk=0.0), (0, 0, 0)
    gains = []
    for _ in range(DRAWS):
        drawn = steady.drawn(ground.problem.cycle, motion.stands, rng)
        left = np.where(ground.used, drawn, 0.0)
        left = left - taken @ (own @ ground.whiten(left[:, None])[:, 0])
        place = family.pick(left, begun)[1]
        cost, innovations = family.weigh(place, left)[0], ground.whiten(left[:, None])[:, 0]
        gains.append(_gain(flexible, left, innovations, place, family, cost))
    return float(np.mean(gains)) / max(flexible.freedom, 1)


def repeated_rest(choice: Choice, prior: NoisePrior) -> Rest:
    """What cycles that repeat have in common at each step in a choice's residual, of any shape.

    It needs no curves and finds what is finer than theirs.
    """
    gain, freedom, count = in_common(choice, prior)
    excess = max(gain - freedom, 0.0) / max(count, 1)
    size = choice.fit.ground.noise.deviation * float(np.sqrt(excess))
    return Rest("each cycle alike", gain, freedom, float(chdtrc(max(freedom, 1), gain)), size)


def common_size(choice: Choice, prior: NoisePrior) -> float:
    """What cycles that repeat have in common in a residual, each about its mean, beyond chance.

    Root mean square [measurement's unit], whatever the noise is taken for: one that walks takes
    what comes again in each cycle for its own, where steps are many and small.
    """
    ground = choice.fit.ground
    off = np.where(ground.used, ground.problem.measured - choice.fit.predicted, np.nan)
    common = apart = 0.0
    count = 0
    for values in steps_again(off, prior.groups):
        values = values[np.isfinite(values).any(axis=1)]
        values = values - np.nanmean(values, axis=1, keepdims=True)
        times, mean = np.isfinite(values).sum(axis=0), np.nanmean(values, axis=0)
        common += float(np.sum(times * mean**2))
        apart += float(np.nansum((values - mean) ** 2 / (times - 1.0)))
        count += int(times.sum())
    return float(np.sqrt(max(common - apart, 0.0) / max(count, 1)))


def two_valued(fit: Fit) -> bool:
    """Whether a fit's innovations are surely flatter than a uniform distribution.

    Of all distributions with one hump the uniform one is the flattest, its excess kurtosis -1.2
    (Darlington, Am. Stat. 24 (1970) 19), known from n samples to about 1 / sqrt(n): then there are
    two humps, as of a sensor that changes between two zeros.
    """
    e = fit.innovations - fit.innovations.mean()
    kurtosis = float(np.mean(e**4)) / max(float(np.mean(e**2)) ** 2, 1e-300)
    return kurtosis < UNIFORM - HUMPS / np.sqrt(len(e))


def followed(fit: Fit) -> np.ndarray:
    """Orthonormal columns of all that calibration and terms can follow, (n, m), not whitened."""
    ground = fit.ground
    plain = evaluate(ground.with_noise(NoiseModel(1.0)), fit.pieces)
    out = np.zeros((len(ground.used), plain.basis.shape[1]))
    out[ground.used] = plain.basis
    return out


def _beside(columns: np.ndarray, ground: Ground, taken: np.ndarray, own: np.ndarray) -> Flexible:
    """Curves (n, k) beside those taken, but for those that are among them.

    own: (m, count) what follows the columns taken (n, m) in whitened ones.
    """
    columns = np.where(ground.used[:, None], columns, 0.0)
    columns = columns - taken @ (own @ ground.whiten(columns))
    free = ground.whiten(columns)
    size = np.sqrt(np.einsum("ij,ij->j", free, free))
    keep = size > 1e-6 * max(float(size.max(initial=0.0)), 1e-12)
    return Flexible(columns[:, keep], free[:, keep])


def curves(problem: Problem) -> dict[str, np.ndarray]:
    """Families of curves over what a residual may depend on, each (n, k)."""
    motion = problem.motion
    drive, cycle = motion.drive, motion.cycle
    up = branch_of(drive) > 0
    ways = [up, ~up]
    out: dict[str, np.ndarray] = {}
    if np.ptp(drive) > 0:
        fine = hats(drive, FINE)
        out["the command and its direction"] = np.column_stack([fine * w[:, None] for w in ways])
        coarse = hats(drive, COARSE)
        numbers = np.unique(cycle[problem.train])
        if len(numbers) > 3:
            odd = (cycle % 2 == 1)[:, None]
            out[EVERY_OTHER] = np.column_stack([fine * (w[:, None] & odd) for w in ways])
        if 1 < len(numbers) <= 20:
            out[CYCLE] = np.column_stack(
                [coarse * (w & (cycle == c))[:, None] for c in numbers for w in ways]
            )
            size = np.column_stack([drive, np.ones(len(drive))])
            out[GAIN_OF_CYCLE] = np.column_stack([size * (cycle == c)[:, None] for c in numbers])
        out[GAIN_IN_TIME] = drive[:, None] * slow_changes(motion.time_s)
        travel = travelled(drive)
        out["the travel since the last reversal"] = np.column_stack(
            [hats(np.sqrt(travel), TRAVELS) * w[:, None] for w in ways]
        )
    for name, other in motion.others.items():
        if np.ptp(other) > 0:
            moving = branch_of(other) > 0
            out[name] = np.column_stack([hats(other, 8) * w[:, None] for w in (moving, ~moving)])
    return out


def slow_changes(time_s: np.ndarray) -> np.ndarray:
    """Legendre polynomials of time (n,) from the first order on, (n, SLOW)."""
    since = (time_s - time_s[0]) / max(float(time_s[-1] - time_s[0]), 1e-300)
    return legendre.legvander(2.0 * since - 1.0, SLOW)[:, 1:]

"""The noise of a recording, learnt from repeated cycles before any physics."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.optimize import minimize
from scipy.special import chdtrc

from pipeline.discrepancy.noise.contrast import FEWEST_STEPS, few, free_of, numbered
from pipeline.discrepancy.noise.force_noise import noise_of_force
from pipeline.discrepancy.noise.noise import NoiseModel, whitened
from pipeline.discrepancy.noise.other_axes import contrasted, ways_of_others, without_ways
from pipeline.discrepancy.problem.outliers import isolated, robust_deviation
from pipeline.discrepancy.problem.problem import Problem
from pipeline.discrepancy.problem.repeats import repeated_cycles
from pipeline.physics.even_grid import quantum_of
from pipeline.physics.motion import Motion

APART = 60
FREE_LEVEL = 1e3
FINEST = 1e-6
BESIDE, BROKEN = 6, 6.0
SURE, UNSURE = 0.08, 0.3
MOVED = 1e-3
FEWEST_FREE = 12


@dataclass(frozen=True)
class NoisePrior:
    """What is known of the noise before the fit.

    model: the likeliest. repeats: how many cycles it was learnt from. sure: how sure its deviation
    is (log scale). series: the contrasts it was learnt from, zero-mean, NaN where missing; stands:
    of each, where all commands stand. finest: least deviation that counts as noise [measurement's
    unit], as that of a level within its converter's step. groups: the cycles that repeat each
    other, see `repeated_cycles`.
    """

    model: NoiseModel
    repeats: int
    sure: float
    series: tuple[np.ndarray, ...]
    finest: float = 1e-9
    stands: tuple[np.ndarray, ...] = ()
    groups: tuple[np.ndarray, ...] = ()

    @property
    def differing(self) -> float:
        """Root mean square of the contrasts, which noise and all that does not repeat make.

        Infinite where there are none.
        """
        if not self.series:
            return float(np.inf)
        return float(np.sqrt(np.nanmean(np.concatenate(self.series) ** 2)))

    @cached_property
    def _contrasts(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
        return _joined(self.series)

    def strain(self, shape: tuple[float, float, bool], walk: float) -> float:
        """-2 log likelihood of the contrasts for a shape of noise, at its likeliest scale.

        shape: share of the variance that is correlated, correlation, and whether that part settles.
        walk: of its step, over the deviation.
        """
        joined, cycle, used, _ = self._contrasts
        share, correlation, settles = shape
        noise = NoiseModel(
            np.sqrt(max(1.0 - share, 1e-6)), np.sqrt(share), correlation, FREE_LEVEL, walk,
            settles=settles,
        )  # fmt: skip
        stands = _gapped(self.stands, False) if settles else np.zeros(len(joined), dtype=bool)
        gains = noise.gains(cycle, used, stands)
        values = np.where(used, joined, 0.0)[:, None]
        e = whitened(values, gains, noise.kept(stands), cycle)[:, 0]
        n = max(int(used.sum()) - len(self.series), 1)
        return n * float(np.log(max(e @ e, 1e-300) / n)) + 2 * float(np.sum(np.log(gains[used, 3])))


def learn_noise(problem: Problem, expected: np.ndarray | None = None) -> NoisePrior:
    """Noise from contrasts of repeated cycles, or from what is rough where nothing repeats.

    A contrast is a sum over repeats whose weights cancel what repeats and what grows linearly
    from repeat to repeat, so that physics of either kind is no noise. Of a force against motion,
    what no flexible law of force leaves out (`force_noise.py`).
    Cycles in which other axes go elsewhere repeat each other where these surely move nothing.
    expected: (n,) what the measurement would be without noise; the simulation, if not told.
    """
    if problem.motion.kinetics is not None:
        model = noise_of_force(problem, problem.motion.kinetics)
        return NoisePrior(model, 0, UNSURE, (), FINEST * problem.around.angle_span)
    expected = problem.simulated if expected is None else expected
    residual = np.where(problem.train, problem.measured - expected, np.nan)
    levels = problem.levels
    rounded = quantum_of(problem.measured) / np.sqrt(12.0) if levels is None else levels.least
    finest = max(FINEST * problem.around.angle_span, rounded)
    groups = repeated_cycles(problem)
    if not groups and problem.motion.others:
        own = repeated_cycles(problem, alone=True)
        groups = [] if moved_by_others(problem.motion, residual, own, finest) else own
    found = [
        (s, stands_in(problem.motion, r)) for r in groups for s in contrasts(residual, r, finest)
    ]
    series, stands = tuple(s for s, _ in found), tuple(still for _, still in found)
    free = sum(np.isfinite(s).sum() - 1 for s in series)
    if free >= FEWEST_FREE:
        repeats, sure = sum(len(g) for g in groups), max(SURE, 1.0 / np.sqrt(2.0 * free))
        model = fit_noise(series, finest)
        return NoisePrior(model, repeats, sure, series, finest, stands, tuple(groups))
    rough = (rough_part(residual, problem),)
    return NoisePrior(fit_noise(rough, finest), 0, UNSURE, (), finest)


def moved_by_others(
    motion: Motion, residual: np.ndarray, groups: Sequence[np.ndarray], finest: float
) -> bool:
    """Whether other axes may move what repeats by the joint's own command (`repeated_cycles`).

    Not where what they do in proportion, by its square, beside the joint's own command or by its
    pace makes contrasts of the residual (n,) no likelier than chance would (likelihood ratio).
    """
    ways = ways_of_others(motion)
    found = []
    for rows in groups:
        values = unmistaken(np.where(rows >= 0, residual[rows], np.nan), finest)
        found += contrasted(values, rows, ways)
    if not found:
        return True
    likely = [
        fitted_likelihood(series, finest)
        for series in ([s[:, 0] for s in found], without_ways(found))
    ]
    gain = 2.0 * (likely[1] - likely[0])
    return bool(chdtrc(ways.shape[1], max(gain, 0.0)) < MOVED)


def fitted_likelihood(series: Sequence[np.ndarray], finest: float) -> float:
    """Log likelihood of zero-mean series under the likeliest noise, up to a constant."""
    model = replace(fit_noise(series, finest), jitter=FREE_LEVEL)
    joined, number, used, _ = _joined(series)
    still = np.zeros(len(joined), dtype=bool)
    return model.log_likelihood(np.where(used, joined, 0.0), number, used, still)


def contrasts(residual: np.ndarray, rows: np.ndarray, finest: float) -> list[np.ndarray]:
    """Contrasts over repeats, unit sums of independent samples, as series (steps,).

    Steps at which the same repeats are measured go together, NaN elsewhere, each with its own mean
    taken off: another set of repeats has another level.
    """
    values = unmistaken(np.where(rows >= 0, residual[rows], np.nan), finest)
    number = numbered(rows)
    have = np.isfinite(values)
    out = []
    for pattern in np.unique(have, axis=1).T:
        steps = np.all(have == pattern[:, None], axis=0)
        degree = 1 if pattern.sum() >= 3 else 0
        if pattern.sum() <= degree + 1 or few(steps):
            continue
        free = free_of(number[pattern], degree)
        for j in range(free.shape[1]):
            series = np.full(values.shape[1], np.nan)
            series[steps] = free[:, j] @ values[np.ix_(pattern, steps)]
            out += [part - np.nanmean(part) for part in unbroken(series, finest)]
    return out


def unmistaken(values: np.ndarray, finest: float) -> np.ndarray:
    """Values (repeats, steps), NaN where one stands off from its cycle as no repeat does.

    Every contrast takes a part of each mistake: few in each cycle are many in all.
    """
    known = np.isfinite(values)
    off = np.full(values.shape, np.nan)
    for k in range(len(values)):
        some = np.delete(known, k, axis=0).any(axis=0)
        off[k, some] = values[k, some] - np.nanmedian(np.delete(values, k, axis=0)[:, some], axis=0)
    whole = np.zeros(values.shape[1])
    lone = [isolated(one, own, finest, whole) for one, own in zip(off, known, strict=True)]
    return np.where(lone, np.nan, values)


def stands_in(motion: Motion, rows: np.ndarray) -> np.ndarray:
    """Where all commands stand in cycles (repeats, steps) of row numbers, -1 for none, (steps,)."""
    return np.asarray(np.any(motion.stands[rows] & (rows >= 0), axis=0))


def unbroken(series: np.ndarray, finest: float) -> list[np.ndarray]:
    """The parts of a series (steps,) between its breaks, each NaN where another is.

    It breaks where its level over BESIDE steps changes by BROKEN times as much as it usually does,
    which is at least `finest`: one of the repeats slipped there. Left in, a slip looks like noise
    that walks.
    """
    known = np.flatnonzero(np.isfinite(series))
    if len(known) < 4 * BESIDE:
        return [series]
    level = np.convolve(series[known], np.full(BESIDE, 1.0 / BESIDE), mode="valid")
    changes = level[BESIDE:] - level[:-BESIDE]
    most = int(np.argmax(np.abs(changes)))
    if abs(changes[most]) < BROKEN * max(robust_deviation(changes), finest):
        return [series]
    later = np.arange(len(series)) >= known[most + BESIDE]
    parts = [np.where(later, np.nan, series), np.where(later, series, np.nan)]
    parts = [whole for part in parts for whole in unbroken(part, finest)]
    return [part for part in parts if np.isfinite(part).sum() >= FEWEST_STEPS]


def rough_part(residual: np.ndarray, problem: Problem) -> np.ndarray:
    """What a local line over neighbouring samples leaves of the residual, scaled to full size."""
    out = np.full(len(residual), np.nan)
    weights = np.array([-0.5, 1.0, -0.5])
    same = np.zeros(len(residual), dtype=bool)
    same[1:-1] = (problem.cycle[:-2] == problem.cycle[2:]) if len(residual) > 2 else False
    middle = np.convolve(residual, weights[::-1], mode="same")
    out[same] = middle[same] / np.sqrt(1.5)
    return out


def _joined(series: Sequence[np.ndarray]) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    """All series in a row with gaps between, their numbers, what is used, their deviation."""
    joined = _gapped(series, np.nan)
    number = np.concatenate([np.full(len(s) + APART, k) for k, s in enumerate(series)])
    used = np.isfinite(joined)
    scale = robust_deviation(joined[used])
    used &= np.abs(np.where(used, joined, 0.0)) < 5.0 * scale
    return joined, number, used, scale


def _gapped(series: Sequence[np.ndarray], gap: float) -> np.ndarray:
    """All series in a row, each followed by a gap."""
    return np.concatenate([part for s in series for part in (s, np.full(APART, gap, s.dtype))])


def fit_noise(series: Sequence[np.ndarray], finest: float = 1e-9) -> NoiseModel:
    """The likeliest noise of zero-mean series with free levels [their unit], at least `finest`."""
    joined, cycle, used, scale = _joined(series)
    if scale <= finest or used.sum() < 5:
        return NoiseModel(white=finest)
    best: tuple[float, NoiseModel] | None = None
    for correlation in (0.4, 0.85):
        for walk in (0.0, 0.05):
            start = NoiseModel(0.7 * scale, 0.5 * scale, correlation, 0.0, walk * scale)
            cost, model = _likeliest(start, joined, cycle, used, scale)
            if best is None or cost < best[0] - 1.0:
                best = (cost, model)
    assert best is not None
    return best[1]


def _likeliest(
    start: NoiseModel, values: np.ndarray, cycle: np.ndarray, used: np.ndarray, scale: float
) -> tuple[float, NoiseModel]:
    walks, moving = start.walk > 0.0, np.zeros(len(values), dtype=bool)

    def model_of(x: np.ndarray) -> NoiseModel:
        return NoiseModel(
            white=float(np.exp(x[0])),
            correlated=float(np.exp(x[1])),
            correlation=float(1.0 / (1.0 + np.exp(-x[2]))),
            jitter=FREE_LEVEL * scale,
            walk=float(np.exp(x[3])) if walks else 0.0,
        )

    def cost(x: np.ndarray) -> float:
        likely = model_of(x).log_likelihood(np.where(used, values, 0.0), cycle, used, moving)
        far = (
            0.5 * ((x[2] - 0.5) / 2.0) ** 2
            + 0.5 * (np.maximum(-8 - (x - np.log(scale)), 0)[:2] ** 2).sum()
        )
        return -likely + far

    x0 = [
        np.log(start.white),
        np.log(start.correlated),
        np.log(start.correlation / (1 - start.correlation)),
    ]
    if walks:
        x0.append(np.log(start.walk))
    found = minimize(
        cost, x0, method="Nelder-Mead", options={"maxfev": 150, "xatol": 0.02, "fatol": 0.02}
    )
    model = model_of(found.x)
    penalty = 3.5 if walks else 0.0
    return float(found.fun) + penalty, NoiseModel(
        model.white, model.correlated, model.correlation, 0.0, model.walk
    )

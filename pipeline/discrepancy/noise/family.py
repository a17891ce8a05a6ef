"""The noises that a fit may choose from: shapes round the one that was learnt."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from math import exp, log

import numpy as np
from numba import njit

from pipeline.discrepancy.noise.learning import NoisePrior
from pipeline.discrepancy.noise.noise import NoiseModel, square_of, whitened
from pipeline.discrepancy.problem.problem import Problem

JITTERS = (0.0, 0.08, 0.16, 0.3, 0.6, 1.2, 2.4, 4.8)
WALKS = (0.0, 0.004, 0.01, 0.017, 0.028, 0.045, 0.08, 0.15)
SHAPES = ((0.0, 0.0), (1.0, 0.35), (1.0, 0.5), (1.0, 0.65), (1.0, 0.78), (0.5, 0.8))
WHITE = 1  # number of the shape without memory: SHAPES come after the one that was learnt
SETTLED = (0.5, 0.9, 0.97, 0.99, 0.997)
STANDING, COARSE = 0.02, 0.5
CAP = 16.0
MIDDLE = 3
MIDDLE_WALK = 4
JITTER_COST = 0.5
WALK_COST = 1.0
UNREPEATED = 12.0  # where nothing repeats, a zero that moves is charged like the drift it hides,
JUDGED = 5.0  # but, once all that may explain it was looked for, a jitter like what is common

Place = tuple[int, int, int]
Shape = tuple[float, float, bool]
Filter = tuple[np.ndarray, np.ndarray, float, np.ndarray]
"""Gains, what is kept from row to row, the sum of the innovations' log variances, and a constant
whitened to length 1 (used rows,)."""


@dataclass(frozen=True)
class NoiseFamily:
    """Noises of unit deviation on the rows of one problem; `pick` finds the likeliest.

    prior: as learnt. used: (n,) rows that count; stands: (n,) those in which all commands stand.
    shapes: (share of the variance that is correlated, correlation, whether that part settles where
    commands stand); strain: (shapes, walks) -2 log of how much worse repeats fit each, at most CAP.
    still: whether the noise keeps the shape of the first, without jitter or walk. steady: whether
    it never jitters or walks, whatever its shape. unrepeated_jitter: -2 log odds against a jitter
    where nothing repeats.
    """

    prior: NoisePrior
    cycle: np.ndarray
    used: np.ndarray
    stands: np.ndarray
    shapes: Sequence[Shape]
    strain: np.ndarray
    still: bool = False
    steady: bool = False
    unrepeated_jitter: float = UNREPEATED
    filters: dict[Place, Filter] = field(default_factory=dict)

    def unit(self, place: Place) -> NoiseModel:
        """The noise at a place of the grid, its deviation 1."""
        share, correlation, settles = self.shapes[place[0]]
        return NoiseModel(
            np.sqrt(max(1.0 - share, 1e-6)), np.sqrt(share), correlation,
            JITTERS[place[1]], WALKS[place[2]], self.prior.model.spell, settles,
        )  # fmt: skip

    def filter_at(self, place: Place) -> Filter:
        """How a residual is whitened and weighed at a place of the grid."""
        if place not in self.filters:
            unit = self.unit(place)
            gains, kept = unit.gains(self.cycle, self.used, self.stands), unit.kept(self.stands)
            level = np.where(self.used, 1.0, 0.0)[:, None]
            level = whitened(level, gains, kept, self.cycle)[:, 0]
            log_scales = 2.0 * float(np.sum(np.log(gains[self.used, 3])))
            self.filters[place] = gains, kept, log_scales, level / np.sqrt(level @ level)
        return self.filters[place]

    def weigh(
        self, place: Place, residual: np.ndarray, level_open: bool = False
    ) -> tuple[float, float]:
        """-2 log posterior at the likeliest scale, and that scale; residual is 0 where not used.

        level_open: at the likeliest level of the residual, too: a walk starts from its first rows.
        """
        gains, kept, log_scales, level = self.filter_at(place)
        spell, deviation = self.prior.model.spell, self.prior.model.deviation
        known = log(deviation), self.prior.sure, log(self.prior.finest)
        whitening = gains, kept, self.cycle, level
        cost, scale = _likeliest(residual, whitening, level_open, spell, known)
        return cost + log_scales / spell + self.charge(place) + self.strained(place), scale

    def charge(self, place: Place) -> float:
        """-2 log odds against a zero that jitters or walks as at a place."""
        if self.prior.repeats > 0:
            return usual_charge(place)
        return self.unrepeated_jitter * (place[1] > 0) + UNREPEATED * (place[2] > 0)

    def strained(self, place: Place) -> float:
        """What repeats have against a place."""
        return float(self.strain[place[0], place[2]])

    def pick(self, residual: np.ndarray, start: Place) -> tuple[NoiseModel, Place]:
        """The likeliest noise for a residual (n,), by descent over the grid from a place."""
        filled = np.where(self.used, residual, 0.0)
        shape = start[0]
        if self.still:
            return self.noise_at(start, self.weigh(start, filled)[1]), start
        begins = {(shape, 0, 0)}
        if not self.steady:
            begins |= {start, (shape, 0, MIDDLE_WALK), (shape, MIDDLE, 0)}
        known = {place: self.weigh(place, filled, level_open=True) for place in begins}
        best = min(known, key=lambda place: known[place][0])
        while True:
            shape, jitter, walk = best
            moves = [(other, jitter, walk) for other in range(len(self.shapes))]
            if not self.steady:
                steps = ((jitter + j, walk + w) for j, w in ((-1, 0), (1, 0), (0, -1), (0, 1)))
                moves += [
                    (shape, j, w) for j, w in steps if 0 <= j < len(JITTERS) and 0 <= w < len(WALKS)
                ]
            for move in moves:
                if move not in known:
                    known[move] = self.weigh(move, filled, level_open=True)
            winner = min(known, key=lambda place: known[place][0])
            if winner == best:
                break
            best = winner
        return self.noise_at(best, known[best][1]), best

    def likely(self, residual: np.ndarray, place: Place) -> list[tuple[float, NoiseModel]]:
        """Noises for a residual (n,) round the likeliest place, each with its probability."""
        filled = np.where(self.used, residual, 0.0)
        shape, jitter, walk = place
        places = {place}
        if not self.still:
            places |= {(shape, j, w) for j in range(len(JITTERS)) for w in range(len(WALKS))}
            places |= {(other, jitter, walk) for other in range(len(self.shapes))}
        weighed = [(p, *self.weigh(p, filled, level_open=True)) for p in sorted(places)]
        least = min(cost for _, cost, _ in weighed)
        odds = [float(np.exp(0.5 * (least - cost))) for _, cost, _ in weighed]
        return [
            (own / sum(odds), self.noise_at(p, scale))
            for own, (p, _, scale) in zip(odds, weighed, strict=True)
        ]

    def noise_at(self, place: Place, scale: float) -> NoiseModel:
        """The noise at a place of the grid with a deviation [measurement's unit]."""
        unit = self.unit(place)
        return replace(
            unit,
            white=unit.white * scale,
            correlated=unit.correlated * scale,
            jitter=unit.jitter * scale,
            walk=unit.walk * scale,
        )


@njit(cache=True, error_model="numpy")
def _likeliest(residual, whitening, level_open, spell, known):  # type: ignore[no-untyped-def]
    """-2 log posterior at a residual's likeliest scale, and that; for the rest see `weigh`.

    whitening: see `square_of`. spell: samples that count as one. known: log of the scale that was
    learnt, how sure that is, and log of the least.
    """
    gains, kept, cycle, level = whitening
    learnt, sure, least = known
    square, along = square_of(residual, gains, kept, cycle, level)
    if level_open:
        square = max(square - along * along, 0.0)
    n = level.size / spell
    log_scale = max(0.5 * log(max(square / n, 1e-300)), least)
    for _ in range(3):
        slope = 2.0 * n - 2.0 * square * exp(-2.0 * log_scale)
        slope += 2.0 * min(max((log_scale - learnt) / sure**2, -2.0 / sure), 2.0 / sure)
        log_scale -= slope / (4.0 * square * exp(-2.0 * log_scale) + 2.0 / sure**2)
        log_scale = max(log_scale, least)
    cost = square * exp(-2.0 * log_scale) + 2.0 * n * log_scale
    off = abs(log_scale - learnt) / sure
    cost += off**2 if off < 2.0 else 4.0 * (off - 1.0)
    return cost, exp(log_scale)


def usual_charge(place: Place) -> float:
    """The same where cycles repeat, so that a drift that it hides is no more usual."""
    return JITTER_COST * (place[1] > 0) + WALK_COST * (place[2] > 0)


def noise_family(prior: NoisePrior, problem: Problem, used: np.ndarray) -> NoiseFamily:
    """The family round what was learnt from repeats, on the used rows (n,) of a problem.

    Where cycles repeat and commands stand for some samples, noise may also be where the joint came
    to rest; where nothing repeats, that can't be told from what a term leaves, but is expected of a
    sensor with coarse levels.
    """
    model, cycle, stands = prior.model, problem.cycle, problem.motion.stands
    if model.spell > 1.0:
        strain = np.zeros((1, len(WALKS)))
        return NoiseFamily(prior, cycle, used, stands, ((0.0, 0.0, False),), strain, still=True)
    share = model.correlated**2 / max(model.deviation**2, 1e-300)
    shapes = [(float(min(share, 1.0)), model.correlation, False)]
    shapes += [(*shape, False) for shape in SHAPES]
    coarse = prior.finest > COARSE * model.deviation
    if (prior.repeats > 0 or coarse) and np.mean(stands[used]) > STANDING:
        shapes += [(settled, 0.0, True) for settled in SETTLED]
    strain = np.zeros((len(shapes), len(WALKS)))
    if prior.series:
        strain = np.array([[prior.strain(shape, walk) for walk in WALKS] for shape in shapes])
        strain = np.minimum(strain - strain.min(), CAP)
    return NoiseFamily(prior, cycle, used, stands, shapes, strain)

"""A sensor that reads in levels: their step, and what a reading is off on average.

Readings of a motion that comes again are off by the same again, as no noise is: the error of a
reading is a sawtooth over what is read (Widrow and Kollar, Quantization Noise, 2008, chapter 4).
What was added to that before it was read rounds the sawtooth off.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import minimize_scalar
from scipy.special import ndtr

from pipeline.discrepancy.problem.stale import levels_of
from pipeline.physics.even_grid import quantum_of

NEIGHBOURS = np.arange(-3, 3) + 0.5
LOST, LEAST, SHARP, BLURRED = 1e-4, 0.02, 0.1, 0.45
ON_ONE, NEARLY_ALL, SAME = 0.05, 0.9, 1e-6
DIGITS, MOST_OF_ONE = 6, 2
SURELY = 0.8  # of what readings deviate by, so that structure beside it is looked for


@dataclass(frozen=True)
class Levels:
    """step: from one level to the next. one: any of them. taken: (n,) what was taken off readings.

    least: the least deviation of readings from what they are on average. All in the measurement's
    unit.
    """

    step: float
    one: float
    taken: np.ndarray
    least: float

    def rows(self, wanted: np.ndarray) -> "Levels":
        """The same for some rows (indices)."""
        return replace(self, taken=self.taken[wanted])

    def spread(self, expected: np.ndarray, measured: np.ndarray) -> tuple[float, float]:
        """The likeliest deviation of noise that was read as well [steps], and -2 log likelihood.

        expected: (n,) what would be measured without noise and levels. measured: (n,), NaN where
        not measured, or not to be counted.
        """
        off = (measured - expected) / self.step
        return likeliest_spread(off[np.isfinite(off)])

    def off_by_reading(
        self, expected: np.ndarray, measured: np.ndarray, spread: float
    ) -> np.ndarray:
        """How far readings (n,) are off by being read, (n,), given what is expected (n,).

        That is what they are off on average; of readings without noise, up to half a step.
        """
        if spread < SHARP:
            return np.clip(measured - expected, -0.5 * self.step, 0.5 * self.step)
        return self.step * read_off((expected + self.taken - self.one) / self.step, spread)

    def less_average(self, spread: float) -> "Levels":
        """The levels of readings without that: they deviate where the next level is near enough.

        Over all places between two levels the variance is the noise's share of both being read.
        """
        deviation = self.step * float(np.sqrt(max(spread, SHARP) / np.sqrt(np.pi)))
        return replace(self, least=SURELY * deviation)


def levels_read(came: np.ndarray, measured: np.ndarray) -> Levels | None:
    """The levels of readings (n,), of which something may have been taken off; None of others.

    Nearly all of them stand on one. A few that come again by chance are not all levels, nor are the
    places that a command comes back to, each read with noise of its own.
    """
    levels = levels_of(came)
    step = step_of(levels)
    if step == 0.0:
        return None
    places = (came[np.isfinite(came)] - levels[0]) / step
    on_one = places[np.abs(places - np.round(places)) < ON_ONE]
    if len(on_one) < NEARLY_ALL * len(places):
        return None
    if len(np.unique(on_one.round(DIGITS))) > MOST_OF_ONE * len(np.unique(on_one.round())):
        return None
    taken = np.where(np.isfinite(measured), came - measured, 0.0)
    return Levels(step, float(levels[0]), taken, step / float(np.sqrt(12.0)))


def step_of(levels: np.ndarray) -> float:
    """The step of some levels (k,), of which none may be next to another; 0.0 where there is none.

    Then it is the step of how far they are apart.
    """
    step = quantum_of(levels)
    if step > 0.0 or len(levels) < 3:
        return step
    apart = np.sort(np.diff(levels))
    differ = np.diff(apart, prepend=0.0) > SAME * apart[-1]
    step = quantum_of(np.concatenate([[0.0], apart[differ]]))
    if step == 0.0:
        return 0.0
    span = float(levels[-1] - levels[0])
    return span / round(span / step)


def likeliest_spread(off: np.ndarray) -> tuple[float, float]:
    """The likeliest deviation of noise [steps] of which readings are so far off (k,) [steps].

    And -2 log likelihood; a few may be mistaken.
    """

    def cost(log_spread: float) -> float:
        spread = np.exp(log_spread)
        chance = ndtr((off + 0.5) / spread) - ndtr((off - 0.5) / spread)
        return -2.0 * float(np.sum(np.log(chance + LOST)))

    found = minimize_scalar(cost, bounds=(np.log(LEAST), 0.0), method="bounded")
    return float(np.exp(found.x)), float(found.fun)


def read_off(place: np.ndarray, spread: float) -> np.ndarray:
    """How far readings of places (n,) [steps] with noise of a spread [steps] are off on average."""
    part = place - np.round(place)
    read = ndtr((part[:, None] - NEIGHBOURS) / spread).sum(axis=1) - 0.5 * len(NEIGHBOURS)
    return np.asarray(read - part)

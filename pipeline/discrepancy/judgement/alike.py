"""How much of what is left of a force comes again when the motion does: that is no noise."""

from dataclasses import dataclass

import numpy as np

from pipeline.discrepancy.noise.force_noise import spell_of
from pipeline.discrepancy.problem.force_problem import top_of
from pipeline.discrepancy.search.weighing import Choice
from pipeline.recording import reversals_of

NEIGHBOURS, STROKES = 24, 2
CLOSEST, FEWEST_PAIRS = 0.5, 100
SLOWEST, STROKES_A_BEND = 12, 4
SURELY = 4.0


@dataclass(frozen=True)
class Alike:
    """share: of the residual's variance that comes again; by_chance: standard error of none."""

    share: float
    by_chance: float

    @property
    def sure(self) -> bool:
        """Whether chance does not give as much."""
        return self.share > SURELY * self.by_chance


NOTHING = Alike(0.0, 1.0)


def alike(choice: Choice) -> Alike:
    """How much of a force's residual is the same where its motion was the same at another time.

    Each row is compared with that row of another stroke whose motion is the most like its own, by
    position, velocity, acceleration and the last two reversals, which dry friction remembers. What
    comes again is no noise, in whatever form; noise that is correlated from row to row is another
    in another stroke. What wanders slowly is taken off first. Only the CLOSEST of the pairs count.
    Source: the pairs of Daniel and Wood, Fitting Equations to Data (1971), chapter 7, for an
    estimate of pure error where nothing is repeated exactly.
    """
    from scipy.spatial import cKDTree

    ground = choice.fit.ground
    traits, stroke = _traits(choice)
    left = ground.problem.measured - choice.fit.predicted
    rows = np.flatnonzero(ground.used & np.isfinite(left) & (stroke >= STROKES))
    if len(rows) < FEWEST_PAIRS:
        return NOTHING
    left, stroke = _quick(left[rows], stroke[rows]), stroke[rows]
    apart, near = cKDTree(traits[rows]).query(traits[rows], k=min(NEIGHBOURS, len(rows)))
    other = np.abs(stroke[near] - stroke[:, None]) >= STROKES
    found = np.flatnonzero(other.any(axis=1))
    if len(found) < FEWEST_PAIRS:
        return NOTHING
    first = np.argmax(other[found], axis=1)
    distance, pair = apart[found, first], near[found, first]
    close = distance <= np.quantile(distance, CLOSEST)
    own, its = left[found[close]], left[pair[close]]
    size = 0.5 * float(own @ own + its @ its)
    chance = np.sqrt(2.0 * spell_of(left, rows) / len(own))
    return Alike(float(own @ its) / max(size, 1e-300), float(chance))


def _traits(choice: Choice) -> tuple[np.ndarray, np.ndarray]:
    """What a row's motion is like, (n, 5) over its range, and the number of its stroke, (n,)."""
    motion = choice.fit.ground.problem.motion
    kinetics, x = motion.kinetics, motion.drive
    assert kinetics is not None
    turns = np.concatenate([[0], reversals_of(x)])
    stroke = np.searchsorted(turns, np.arange(len(x)), side="right") - 1
    last, before = (x[turns[np.maximum(stroke - k, 0)]] for k in (0, 1))
    speed, acceleration = (
        values / max(top_of(values), 1e-300)
        for values in (kinetics.velocity, kinetics.acceleration)
    )
    ways = np.column_stack([x, 0.5 * last, 0.25 * before]) / max(float(np.ptp(x)), 1e-300)
    return np.column_stack([ways, 0.5 * speed, 0.5 * acceleration]), stroke


def _quick(left: np.ndarray, stroke: np.ndarray) -> np.ndarray:
    """A residual (m,) less a polynomial of time that bends no more than once in a few strokes."""
    bends = int(np.clip((stroke[-1] - stroke[0]) / STROKES_A_BEND, 1, SLOWEST))
    slow = np.polynomial.legendre.legvander(np.linspace(-1.0, 1.0, len(left)), bends)
    return np.asarray(left - slow @ np.linalg.lstsq(slow, left, rcond=None)[0])

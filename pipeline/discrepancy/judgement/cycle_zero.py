"""A zero that differs from cycle to cycle by more than noise does: that is a drift."""

import numpy as np
from scipy.special import chdtri, fdtrc

from pipeline.discrepancy.model.result import Estimate, Evidence, NamedPhysics
from pipeline.discrepancy.problem.problem import Problem
from pipeline.discrepancy.search.weighing import Choice
from pipeline.number_words import worded
from pipeline.physics.drift import Drift
from pipeline.physics.lost_steps import LostSteps

FEWEST_CYCLES, ENOUGH_CYCLES, BESIDE_SLIPS, OF_FEW = 3, 5, 2.0, 2.0
SURELY, WITHIN = 0.9, 0.95
SAYS = "The zero is another one in each cycle, by about {size} {unit}: no command foretells it."
OR_SLIPPED = " It stands at two levels, one after the other: one slip in between leaves the same."


def wanders_by_cycle(choice: Choice) -> bool:
    """Whether each cycle's zero surely jitters by more than the noise, beside slips by much more.

    Slips that are named take some of it. Where a drift is, that is it. Of few cycles it has to be
    much more, too, for their zeros may differ so by chance.
    """
    noise = choice.fit.ground.noise
    if noise.jitter == 0.0 or Drift.name in choice.fit.slow:
        return False
    if choice.fit.slow and not leaves_less(choice):
        return False
    means, least = zeros_of(choice), noise.deviation * (BESIDE_SLIPS if choice.fit.slow else 1.0)
    if len(means) < ENOUGH_CYCLES:
        return len(means) >= FEWEST_CYCLES and deviation_of(means)[0] > OF_FEW * least
    return deviation_of(means)[1] > least


def leaves_less(choice: Choice) -> bool:
    """Whether a choice's names leave no more, by themselves, than there was without them.

    Else a zero that wanders takes back what they do. Calibration alone has none, and follows such a
    zero no better than the simulation as it came.
    """
    if not choice.fit.pieces:
        return True
    ground = choice.fit.ground
    before, left = (
        float(np.var((ground.problem.measured - told)[ground.used]))
        for told in (ground.problem.simulated, choice.fit.predicted)
    )
    return left <= before


def zeros_of(choice: Choice) -> np.ndarray:
    """The mean residual of each cycle that was fitted [measurement's unit]."""
    ground = choice.fit.ground
    residual = (ground.problem.measured - choice.fit.predicted)[ground.used]
    numbers = ground.problem.cycle[ground.used]
    return np.array([residual[numbers == c].mean() for c in np.unique(numbers)])


def deviation_of(means: np.ndarray) -> tuple[float, float, float]:
    """The deviation of Gaussian values (n,), and its 95 % interval (chi-squared)."""
    size, free = float(np.std(means, ddof=1)), len(means) - 1
    tails = 0.5 * (1.0 - WITHIN), 0.5 * (1.0 + WITHIN)
    low, high = (size * float(np.sqrt(free / chdtri(free, tail))) for tail in tails)
    return size, low, high


def stepped(means: np.ndarray) -> bool:
    """Whether Gaussian values (n,) surely stand at two levels, one after the other, or may.

    F test of the best of the n - 1 steps, for as many tests (Bonferroni). Few may in any case.
    """
    count = len(means)
    if count < ENOUGH_CYCLES:
        return True
    parts = [(means[:k], means[k:]) for k in range(1, count)]
    left = min(sum(float(np.sum((p - p.mean()) ** 2)) for p in both) for both in parts)
    gained = float(np.sum((means - means.mean()) ** 2)) - left
    ratio = gained / max(left / (count - 2), 1e-300)
    return bool((count - 1) * fdtrc(1, count - 2, ratio) < 1.0 - WITHIN)


def about_each_zero(residual: np.ndarray, cycle: np.ndarray, counted: np.ndarray) -> np.ndarray:
    """A residual (n,) less its mean over the counted rows (n,) of each cycle that has some."""
    numbers = np.unique(cycle[counted])
    place = np.searchsorted(numbers, cycle)
    sums = np.bincount(place[counted], weights=residual[counted], minlength=len(numbers) + 1)
    counts = np.bincount(place[counted], minlength=len(numbers) + 1)
    return np.asarray(residual - (sums / np.maximum(counts, 1))[place])


def zero_of_each_cycle(problem: Problem, choice: Choice, evidence: Evidence) -> NamedPhysics | None:
    """The drift of a zero that wanders from cycle to cycle: the deviation of the cycles' means.

    A slip that lies in a held-out cycle, or between two, leaves such zeros as well.
    """
    if not wanders_by_cycle(choice):
        return None
    means = zeros_of(choice)
    size, low, high = deviation_of(means)
    slipped = stepped(means)
    unit = problem.around.angle_unit
    told = Estimate("deviation", size, low, high, unit)
    says = SAYS.format(size=worded(size), unit=unit) + (OR_SLIPPED if slipped else "")
    return told_as_drift(evidence, told, says, (LostSteps.name,) if slipped else ())


def told_as_drift(
    evidence: Evidence, size: Estimate, says: str, alternatives: tuple[str, ...] = ()
) -> NamedPhysics:
    """The drift of a zero that no course foretells: the corrected simulation has none of it."""
    off, counted = evidence.measured - evidence.after, evidence.heldout & evidence.used
    return NamedPhysics(
        name=Drift.name,
        site=Drift.site,
        probability=SURELY,
        parameters=(size,),
        heldout_rmse_without=float(np.sqrt(np.mean(off[counted] ** 2))),
        alternatives=alternatives,
        says=says,
    )

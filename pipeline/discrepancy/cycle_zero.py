"""A zero that differs from cycle to cycle by more than noise does: that is a drift."""

import numpy as np
from scipy.stats import chi2

from pipeline.discrepancy.choose import SLOW, Choice
from pipeline.discrepancy.problem import Problem
from pipeline.discrepancy.result import Estimate, Evidence, NamedPhysics
from pipeline.physics.drift import Drift

FEWEST_CYCLES = 5
SURELY, WITHIN = 0.9, 0.95
SAYS = "The zero is another one in each cycle, by about {size:.3g} {unit}: no command foretells it."


def wanders_by_cycle(choice: Choice) -> bool:
    """Whether each cycle's zero surely jitters by more than the noise; nothing slow is named."""
    noise = choice.fit.ground.noise
    if noise.jitter == 0.0 or set(choice.fit.names) & set(SLOW):
        return False
    means = zeros_of(choice)
    return len(means) >= FEWEST_CYCLES and deviation_of(means)[1] > noise.deviation


def zeros_of(choice: Choice) -> np.ndarray:
    """The mean residual of each cycle that was fitted [measurement's unit]."""
    ground = choice.fit.ground
    residual = (ground.problem.measured - choice.fit.predicted)[ground.used]
    numbers = ground.problem.cycle[ground.used]
    return np.array([residual[numbers == c].mean() for c in np.unique(numbers)])


def deviation_of(means: np.ndarray) -> tuple[float, float, float]:
    """The deviation of Gaussian values (n,), and its 95 % interval (chi-squared)."""
    size, free = float(np.std(means, ddof=1)), len(means) - 1
    low, high = (size * float(np.sqrt(free / q)) for q in chi2.interval(WITHIN, free)[::-1])
    return size, low, high


def about_each_zero(residual: np.ndarray, cycle: np.ndarray, counted: np.ndarray) -> np.ndarray:
    """A residual (n,) less its mean over the counted rows (n,) of each cycle that has some."""
    numbers = np.unique(cycle[counted])
    place = np.searchsorted(numbers, cycle)
    sums = np.bincount(place[counted], weights=residual[counted], minlength=len(numbers) + 1)
    counts = np.bincount(place[counted], minlength=len(numbers) + 1)
    return np.asarray(residual - (sums / np.maximum(counts, 1))[place])


def zero_of_each_cycle(problem: Problem, choice: Choice, evidence: Evidence) -> NamedPhysics | None:
    """The drift of a zero that wanders from cycle to cycle: the deviation of the cycles' means."""
    if not wanders_by_cycle(choice):
        return None
    size, low, high = deviation_of(zeros_of(choice))
    unit = problem.around.angle_unit
    off, counted = evidence.measured - evidence.after, evidence.heldout & evidence.used
    return NamedPhysics(
        name=Drift.name,
        site=Drift.site,
        probability=SURELY,
        parameters=(Estimate("deviation", size, low, high, unit),),
        heldout_rmse_without=float(np.sqrt(np.mean(off[counted] ** 2))),
        alternatives=(),
        says=SAYS.format(size=size, unit=unit),
    )

"""A zero that differs from cycle to cycle by more than noise does: that is a drift."""

import numpy as np
from scipy.stats import chi2

from pipeline.discrepancy.choose import SLOW, Choice
from pipeline.discrepancy.problem import Problem
from pipeline.discrepancy.result import Estimate, Evidence, NamedPhysics
from pipeline.physics.drift import Drift

LARGE, FEWEST_CYCLES = 1.0, 5
SURELY, WITHIN = 0.9, 0.95
SAYS = "The zero is another one in each cycle, by about {size:.3g} {unit}: no command foretells it."


def wanders_by_cycle(choice: Choice) -> bool:
    """Whether each cycle's zero jitters by more than the noise, and nothing slow is named."""
    fit = choice.fit
    cycles = np.unique(fit.ground.problem.cycle[fit.ground.used])
    noise = fit.ground.noise
    large = noise.jitter > LARGE * noise.deviation and len(cycles) >= FEWEST_CYCLES
    return large and not set(fit.names) & set(SLOW)


def about_each_zero(residual: np.ndarray, cycle: np.ndarray, counted: np.ndarray) -> np.ndarray:
    """A residual (n,) less its mean over the counted rows (n,) of each cycle that has some."""
    numbers = np.unique(cycle[counted])
    place = np.searchsorted(numbers, cycle)
    sums = np.bincount(place[counted], weights=residual[counted], minlength=len(numbers) + 1)
    counts = np.bincount(place[counted], minlength=len(numbers) + 1)
    return np.asarray(residual - (sums / np.maximum(counts, 1))[place])


def zero_of_each_cycle(problem: Problem, choice: Choice, evidence: Evidence) -> NamedPhysics:
    """The drift of a zero that wanders from cycle to cycle: the deviation of the cycles' means.

    Its interval is that of a Gaussian's deviation (chi-squared).
    """
    ground = choice.fit.ground
    residual = ground.problem.measured - choice.fit.predicted
    numbers = ground.problem.cycle[ground.used]
    means = np.array([residual[ground.used][numbers == c].mean() for c in np.unique(numbers)])
    size, free = float(np.std(means, ddof=1)), len(means) - 1
    low, high = (size * float(np.sqrt(free / q)) for q in chi2.interval(WITHIN, free)[::-1])
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

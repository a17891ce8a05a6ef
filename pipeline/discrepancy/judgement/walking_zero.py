"""A zero that walks by many times the noise, as cycles that repeat bear out: that is a drift."""

import numpy as np

from pipeline.discrepancy.judgement.cycle_zero import leaves_less, told_as_drift
from pipeline.discrepancy.model.intervals import DEVIATIONS
from pipeline.discrepancy.model.result import Estimate, Evidence, NamedPhysics
from pipeline.discrepancy.search.explain import Explanation
from pipeline.discrepancy.search.refuted import refuted
from pipeline.discrepancy.search.weighing import FAR_WALK, Choice
from pipeline.number_words import worded

SAYS = "The zero walks by about {size} {unit} in a cycle: no command foretells it."
BESIDE_NAMES = 9.0


def witnessed(explanation: Explanation, choice: Choice) -> bool:
    """Whether the zero of an angle walks, and cycles that repeat don't speak against that."""
    walks = choice.fit.ground.noise.walk > 0.0 and explanation.problem.derivatives is None
    return walks and explanation.prior.repeats > 0 and not refuted(explanation.search, choice)


def walks_far(explanation: Explanation, choice: Choice) -> bool:
    """Whether the zero surely walks by many times the noise; beside names fewer are enough.

    Where others say that the simulation leaves things out, a drift is likelier; but not where they
    leave more than there was without them.
    """
    if not (witnessed(explanation, choice) and leaves_less(choice)):
        return False
    ground = choice.fit.ground
    left = (ground.problem.measured - choice.fit.predicted)[ground.used]
    return bool(np.var(left) > far_walk(choice) * ground.noise.deviation**2)


def far_walk(choice: Choice) -> float:
    """How many times the noise's variance a zero that walks leaves that is not noise any more."""
    return BESIDE_NAMES if choice.fit.pieces else FAR_WALK


def walk_in_a_cycle(choice: Choice) -> float:
    """How far the zero walks in a cycle [measurement's unit]."""
    ground = choice.fit.ground
    rows = len(ground.used) / len(np.unique(ground.problem.cycle))
    return ground.noise.walk * float(np.sqrt(rows))


def zero_that_walks(
    explanation: Explanation, choice: Choice, evidence: Evidence
) -> NamedPhysics | None:
    """The drift of a zero that walks far: the deviation of its steps over a cycle."""
    if not walks_far(explanation, choice):
        return None
    size = walk_in_a_cycle(choice)
    steps = len(np.unique(choice.fit.ground.problem.cycle))
    spread = DEVIATIONS / np.sqrt(2.0 * steps)
    low, high = size * max(1.0 - spread, 0.0), size * (1.0 + spread)
    unit = explanation.problem.around.angle_unit
    told = Estimate("walk_in_a_cycle", size, low, high, unit)
    return told_as_drift(evidence, told, SAYS.format(size=worded(size), unit=unit))

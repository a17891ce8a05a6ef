"""An angle explained, also as a sensor with levels reads it and as its simulation moves itself."""

import numpy as np

from pipeline.discrepancy.judgement.decision import predicted_by
from pipeline.discrepancy.problem.levels import BLURRED
from pipeline.discrepancy.problem.problem import Problem
from pipeline.discrepancy.problem.thinning import thinned
from pipeline.discrepancy.search.explain import Explanation, explain
from pipeline.discrepancy.search.refuted import not_noise
from pipeline.discrepancy.search.weighing import by_names

TRIED, CLEARLY = 12, 2.0


def explained(problem: Problem) -> tuple[Problem, Explanation]:
    """The problem of an angle as it suits its explanation best, and that.

    Where the simulation does a little beside its curve, its trace may drive as well: what explains
    the rest better says it. What readings in levels are off on average is known once what they
    should have read is; then it is taken off them.
    """
    explanation = explain(thinned(problem)[0])
    if problem.traced is not None and unclear(explanation):
        other = explain(thinned(problem.traced)[0])
        if better_by_row(other, explanation):
            problem, explanation = problem.traced, other
    between = between_levels(problem, explanation)
    if between is problem:
        return problem, explanation
    return between, explain(thinned(between)[0])


def between_levels(problem: Problem, explanation: Explanation) -> Problem:
    """The problem without what its readings in levels are off on average, where that shows.

    What should have been read is what makes the readings likeliest: what explains them best as they
    are may follow their levels. It does not show beside as much noise as makes each level as likely
    as those beside it.
    """
    levels, seen = problem.levels, np.where(problem.train, problem.measured, np.nan)
    if levels is None:
        return problem
    tried = []
    for choice in by_names(explanation.choices)[:TRIED]:
        expected = predicted_by(problem, choice)
        spread, cost = levels.spread(expected, seen)
        tried.append((cost + choice.score - choice.fit.cost, spread, expected))
    _, spread, expected = min(tried, key=lambda one: one[0])
    return problem if spread > BLURRED else problem.between_levels(levels, expected, spread)


def unclear(explanation: Explanation) -> bool:
    """Whether anything is left out, as the problem is."""
    best = explanation.choices[0]
    return bool(best.fit.pieces) or not_noise(explanation.search, best)


def better_by_row(other: Explanation, explanation: Explanation) -> bool:
    """Whether another explanation, which may count a few rows more or less, is clearly better."""
    rows = int(explanation.used.sum())
    score = other.choices[0].score * rows / int(other.used.sum())
    return score < explanation.choices[0].score - CLEARLY

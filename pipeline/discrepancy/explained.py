"""An angle explained, also as a sensor with levels reads it and as its simulation moves itself."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from pipeline.discrepancy.fitting.fit import evaluate, improve
from pipeline.discrepancy.judgement.rivals import predicted_by
from pipeline.discrepancy.problem.cornered import moved_on
from pipeline.discrepancy.problem.levels import BLURRED
from pipeline.discrepancy.problem.one_wire import LOOSENING, held_by_one, held_by_one_wire
from pipeline.discrepancy.problem.problem import Problem
from pipeline.discrepancy.problem.thinning import thinned
from pipeline.discrepancy.search.explain import Explanation, explain
from pipeline.discrepancy.search.refuted import not_noise
from pipeline.discrepancy.search.weighing import by_names
from pipeline.physics.term import Term

TRIED, FEW, CLEARLY, NEARLY = 12, 2, 2.0, 0.8


def explained(problem: Problem) -> tuple[Problem, Explanation]:
    """The problem of an angle as it suits its explanation best, and that.

    Where the simulation does a little beside its curve, that may be a course of its own, or its
    trace may drive as well, a lag of its own may come before the joint, under its loads or behind
    it, friction of its own be at the joint or at the drive, and its play come before what alters
    the drive or after: what explains the rest better says it. What readings in levels are off on
    average is known once what they should have read is; then it is taken off them.
    """
    explanation = explain(thinned(problem)[0])
    ways = on_its_course, otherwise_simulated, under_load, moved_first, otherwise_moved, on_one_wire
    for otherwise in ways:
        other = otherwise(problem, explanation)
        if other is not None:
            found = explain(thinned(other)[0])
            if better_by_row(found, explanation) and loosened_if_on_one_wire(found):
                problem, explanation = other, found
    between = between_levels(problem, explanation)
    if between is problem:
        return problem, explanation
    return between, explain(thinned(between)[0])


def on_its_course(problem: Problem, explanation: Explanation) -> Problem | None:
    """The problem with what the simulation does beside its curve as a course of its own."""
    return problem.coursed if unclear(explanation) else None


def otherwise_simulated(problem: Problem, explanation: Explanation) -> Problem | None:
    """The problem with its simulation taken apart in another way, where that may explain more.

    Its trace may drive in place of a curve, its own lag come last, behind the joint, or its own
    friction be elsewhere, if some choice is better so.
    """
    if not unclear(explanation):
        return None
    if problem.traced is not None:
        return problem.traced
    return otherwise_loaded(problem.elsewhere or problem.late_last, explanation)


def under_load(problem: Problem, explanation: Explanation) -> Problem | None:
    """The problem with the simulation's own lag or creep under the loads of the joint, if better.

    What holds or frees the joint makes either of another size there.
    """
    return otherwise_loaded(problem.loaded, explanation) if unclear(explanation) else None


def moved_first(problem: Problem, explanation: Explanation) -> Problem | None:
    """The problem with the simulation's own play ahead of what alters the drive, if better so.

    The drum that runs out of true may be on either side of a gear with play.
    """
    other = problem.moved_first if unclear(explanation) else None
    return where_better(other, explanation, lambda term: term.before_curve)


def otherwise_loaded(other: Problem | None, explanation: Explanation) -> Problem | None:
    """Another problem, if there is one, and what loads the joint explains more there."""
    return where_better(other, explanation, lambda term: term.in_balance)


def otherwise_moved(problem: Problem, explanation: Explanation) -> Problem | None:
    """The problem with its commands turning between samples, where that may explain more."""
    if problem.motion.corners is not None or not unclear(explanation):
        return None
    other = replace(problem, motion=moved_on(problem.motion))
    if other.motion.corners is None:
        return None
    return where_better(other, explanation, lambda term: bool(term.remembers))


def on_one_wire(problem: Problem, explanation: Explanation) -> Problem | None:
    """The problem of a joint that one wire holds, and two in its simulation, where that may be.

    The one in which slack or soft wire explains most all by itself, and NEARLY as much as the best
    of all does: these take the other wire's pull away.
    """
    search, best = explanation.search, explanation.choices[0]
    loose = {
        (p.term.name, p.term.form): p
        for c in by_names([*explanation.choices, *search.seen.values()])
        for p in c.fit.pieces
        if p.term.name in LOOSENING
    }
    others = held_by_one_wire(problem) if loose and unclear(explanation) else []
    found, least = None, np.inf
    for other in others:
        ground = replace(best.fit.ground, problem=thinned(other)[0])
        empty = search.weighed(evaluate(ground, ()), best.place).score
        alone = [improve(evaluate(ground, (piece,))) for piece in loose.values()]
        score = min(search.weighed(fit, best.place).score for fit in alone)
        if score < min(least, empty - NEARLY * (empty - best.score)):
            found, least = other, score
    return found


def loosened_if_on_one_wire(found: Explanation) -> bool:
    """Whether the best of an explanation loosens the joint, if its problem has one wire hold it."""
    loosened = not LOOSENING.isdisjoint(found.choices[0].fit.names)
    return loosened or not held_by_one(found.problem)


def where_better(
    other: Problem | None, explanation: Explanation, concerned: Callable[[Term], bool]
) -> Problem | None:
    """Another problem, if there is one, and terms that are concerned explain more there."""
    if other is None or not promising(other, explanation, concerned):
        return None
    return other


def promising(other: Problem, explanation: Explanation, concerned: Callable[[Term], bool]) -> bool:
    """Whether some choice with terms that are concerned explains more in another problem.

    A few terms may: what is piled up in their place leads the choices.
    """
    small, search = thinned(other)[0], explanation.search
    own = [
        c
        for c in by_names([*explanation.choices, *search.seen.values()])
        if any(concerned(p.term) for p in c.fit.pieces)
    ]
    few = [c for c in own if len(c.fit.pieces) <= FEW]
    for choice in [*few[:TRIED], *own[:TRIED]]:
        fit = choice.fit
        ground = replace(fit.ground, problem=small)
        trial = search.weighed(improve(evaluate(ground, fit.pieces)), choice.place)
        if trial.score < explanation.choices[0].score - CLEARLY:
            return True
    return False


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

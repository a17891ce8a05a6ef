"""A force that comes late: moved by its delay, then as a whole behind a lag."""

from dataclasses import replace

import numpy as np

from pipeline.discrepancy.fitting.charge import complexity, independent
from pipeline.discrepancy.fitting.fit import Fit, evaluate, improve
from pipeline.discrepancy.fitting.reform import reformed
from pipeline.discrepancy.problem.force_problem import averaged
from pipeline.discrepancy.problem.problem import Problem
from pipeline.discrepancy.search.choose import (
    LEAST_GAIN,
    MOST_TERMS,
    Choice,
    Search,
    among,
    best_of_each,
    extended,
    grown,
)
from pipeline.discrepancy.search.excited import further_terms
from pipeline.discrepancy.search.explain import Explanation, explain
from pipeline.discrepancy.search.force_delay import delay_of, late
from pipeline.discrepancy.search.polish import polished
from pipeline.physics.catalogue import LATE, SPRUNG
from pipeline.physics.frame_lag import FrameLag
from pipeline.physics.viscous_friction import ViscousFriction

WORTH = 0.5


def explained_in_time(problem: Problem) -> tuple[Problem, Explanation]:
    """The problem of a force moved by its delay, and what explains it there.

    A lag comes before any delay: it is late by more, and what is moved at first in its place hides
    it. Beside a lag, or what is found once it is moved, the delay may be another: then both are
    looked for once more. A delay beside which nothing explains the force as well as without one is
    none.
    """
    came = lagging(explain(averaged(problem)[0]))
    moved, found = explained_with(problem, came)
    if moved is problem or better(came.choices[0], found.choices[0]):
        return problem, came
    if not comes_late(found.choices[0].fit):
        again = delay_of(problem, found.choices[0].fit)
        if abs(again.value - moved.delay.value) <= moved.delay.high - moved.delay.value:
            return moved, found
    return explained_with(problem, found)


def comes_late(fit: Fit) -> bool:
    """Whether a fit has a lag of all the force."""
    forms = {(term.name, term.form) for term in LATE}
    return any((p.term.name, p.term.form) in forms for p in fit.pieces)


def better(choice: Choice, other: Choice) -> bool:
    """Whether a choice explains a force better than another that was judged beside other noise.

    Their scores count other rows as one: here both leave as many errors as the first one's do.
    """
    count = independent(choice.fit.ground)
    left, other_left = (
        2.0 * count * np.log(c.fit.ground.noise.deviation) + complexity(c.fit)
        for c in (choice, other)
    )
    return bool(left < other_left)


def explained_with(problem: Problem, known: Explanation) -> tuple[Problem, Explanation]:
    """The problem moved by the delay beside what is known, and what explains it, with a lag.

    Where all of the force is old, that is its delay.
    """
    best = known.choices[0].fit
    if FrameLag.name in best.names:
        return problem, known
    delay = delay_of(problem, best)
    if delay.value == 0.0:
        return problem, known
    problem = late(problem, delay)
    return problem, lagging(explain(averaged(problem)[0]))


def lagging(explanation: Explanation) -> Explanation:
    """The explanation with choices that a lag of all the force, or a further term, makes better.

    A lag rounds the force's turns as bristles do, and as a damper behind a spring: from the start
    it would take the place of either, and they take its place where it is. So it is looked for
    beside the best choice, beside that with its damper without the spring, in place of each of its
    terms, and beside nothing: what comes late may have been drawn by a pile of other names. So may
    what further terms draw (`further_terms`).
    """
    search, best = explanation.search, explanation.choices[0]
    problem = best.fit.ground.problem
    parents = [best]
    for k, piece in enumerate(best.fit.pieces):
        rest = improve(evaluate(best.fit.ground, best.fit.without(piece)))
        parents.append(search.weighed(rest, best.place))
        if (piece.term.name, piece.term.form) == (SPRUNG.name, SPRUNG.form):
            parents.append(search.weighed(reformed(best.fit, k, ViscousFriction()), best.place))
    own = among(search, problem, (*LATE, *further_terms(problem)))
    every = among(search, problem, (*search.terms, SPRUNG, *own.terms))
    found = [grown(own, child) for parent in parents for child in extended(own, parent)]
    alone = next(c for c in explanation.choices if not c.fit.pieces)
    found += [joined(every, child) for child in extended(own, alone)]
    if min((c.score for c in found), default=best.score) >= best.score:
        return explanation
    told = polished(every, [*explanation.choices, *found])
    kept = [c for c in told if not piles_up(c, best)]
    return replace(explanation, choices=best_of_each([*explanation.choices, *kept]))


def piles_up(choice: Choice, best: Choice) -> bool:
    """Whether a choice has more names than the best one, and leaves nearly as much for each."""
    more = len(set(choice.fit.names)) - len(set(best.fit.names))
    left, best_left = (c.fit.ground.noise.deviation**2 for c in (choice, best))
    return more > 0 and left > WORTH**more * best_left


def joined(search: Search, choice: Choice) -> Choice:
    """The choice with further terms, the best at each step, as long as it gets better."""
    while len(choice.fit.pieces) < MOST_TERMS:
        further = [choice, *(grown(search, c) for c in extended(search, choice))]
        best = min(further, key=lambda c: c.score)
        if best.score > choice.score - LEAST_GAIN:
            break
        choice = best
    return choice

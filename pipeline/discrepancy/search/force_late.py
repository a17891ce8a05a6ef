"""A force that comes late: moved by its delay, then as a whole behind a lag."""

from dataclasses import replace

import numpy as np

from pipeline.discrepancy.fitting.charge import complexity, independent
from pipeline.discrepancy.fitting.reform import reformed
from pipeline.discrepancy.problem.force_problem import averaged
from pipeline.discrepancy.problem.problem import Problem
from pipeline.discrepancy.search.choose import Choice, among, best_of_each, extended
from pipeline.discrepancy.search.explain import Explanation, explain
from pipeline.discrepancy.search.force_delay import delay_of, late
from pipeline.discrepancy.search.polish import polished
from pipeline.physics.catalogue import LATE, SPRUNG
from pipeline.physics.viscous_friction import ViscousFriction


def explained_in_time(problem: Problem) -> tuple[Problem, Explanation]:
    """The problem of a force moved by its delay, and what explains it there.

    Beside a lag the delay is another: then both are looked for once more. A delay beside which
    nothing explains the force as well as without one is none.
    """
    came = explain(averaged(problem)[0])
    moved, found = explained_with(problem, came)
    if moved is not problem and better(came.choices[0], found.choices[0]):
        return problem, lagging(came)
    if LATE.name not in found.choices[0].fit.names:
        return moved, found
    return explained_with(problem, found)


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
    """The problem moved by the delay beside what is known, and what explains it, with a lag."""
    delay = delay_of(problem, known.choices[0].fit)
    if delay.value == 0.0:
        return problem, lagging(known)
    problem = late(problem, delay)
    return problem, lagging(explain(averaged(problem)[0]))


def lagging(explanation: Explanation) -> Explanation:
    """The explanation with choices that a lag of all the force makes better, polished.

    A lag rounds the force's turns as bristles do, and as a damper behind a spring: from the start
    it would take the place of either, and they take its place where it is. So it is looked for
    beside the best choice, and beside that with its damper without the spring.
    """
    search, best = explanation.search, explanation.choices[0]
    parents = [best]
    for k, piece in enumerate(best.fit.pieces):
        if (piece.term.name, piece.term.form) == (SPRUNG.name, SPRUNG.form):
            parents.append(search.weighed(reformed(best.fit, k, ViscousFriction()), best.place))
    own = among(search, best.fit.ground.problem, (LATE,))
    found = [child for parent in parents for child in extended(own, parent)]
    if min((c.score for c in found), default=best.score) >= best.score:
        return explanation
    every = among(search, best.fit.ground.problem, (*search.terms, SPRUNG, LATE))
    told = polished(every, [*explanation.choices, *found])
    return replace(explanation, choices=best_of_each([*explanation.choices, *told]))

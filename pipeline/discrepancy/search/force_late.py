"""A force that comes late: moved by its delay, then as a whole behind a lag."""

import numpy as np

from pipeline.discrepancy.fitting.charge import complexity, independent
from pipeline.discrepancy.fitting.fit import Fit
from pipeline.discrepancy.problem.force_problem import averaged
from pipeline.discrepancy.problem.problem import Problem
from pipeline.discrepancy.search.explain import Explanation, explain
from pipeline.discrepancy.search.force_again import searched_again
from pipeline.discrepancy.search.force_delay import delay_of, late
from pipeline.discrepancy.search.weighing import Choice
from pipeline.physics.catalogue import LATE
from pipeline.physics.frame_lag import FrameLag


def explained_in_time(problem: Problem) -> tuple[Problem, Explanation]:
    """The problem of a force moved by its delay, and what explains it there.

    A lag comes before any delay: it is late by more, and what is moved at first in its place hides
    it. Beside a lag, or what is found once it is moved, the delay may be another: then both are
    looked for once more. A delay beside which nothing explains the force as well as without one is
    none.
    """
    came = searched_again(explain(averaged(problem)[0]))
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
    return problem, searched_again(explain(averaged(problem)[0]))

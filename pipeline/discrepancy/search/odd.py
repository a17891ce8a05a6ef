"""What is seldom, or no name of the catalogue, in place of what mops it up."""

from itertools import combinations

from pipeline.discrepancy.fitting.fit import ITERATIONS, evaluate, improve
from pipeline.discrepancy.fitting.screen import screen, started
from pipeline.discrepancy.search.choose import (
    LEAST_GAIN,
    Choice,
    Search,
    allowed,
    among,
    best_of_each,
    by_term,
)
from pipeline.discrepancy.search.polish import polished
from pipeline.physics.catalogue import ODD

STEPS, NEAR, MOST_KEPT = 4, 40.0, 2


def oddly(search: Search, choices: list[Choice]) -> list[Choice]:
    """The choices (best first), and those with one of ODD beside no more than two of its pieces.

    Or in place of one of them. A search takes other names for what these explain, two or three for
    each, and no step leads from there. It does not begin with them: each comes near what a usual
    term does, and would hide that.
    """
    best, ground = choices[0], choices[0].fit.ground
    motion, around = ground.problem.motion, ground.problem.around
    shown = tuple(t for t in ODD if t.excited(motion, around))
    if motion.kinetics is not None or ground.problem.mixed or not shown:
        return choices
    other = among(search, ground.problem, shown)
    pieces = best.fit.pieces
    few = (rest for size in range(MOST_KEPT + 1) for rest in combinations(pieces, size))
    kept = {tuple(map(id, rest)): rest for rest in (*few, *map(best.fit.without, pieces))}
    found: list[Choice] = []
    for rest in kept.values():
        fit = improve(evaluate(ground, rest), STEPS)
        for leads in by_term(screen(fit, other.effects, allowed(shown, fit), quick=True)):
            trial = improve(started(fit, leads), STEPS)
            if search.hoped(trial, best.place) < best.score + NEAR:
                found.append(search.weighed(improve(trial, 2 * ITERATIONS), best.place))
    if min((c.score for c in found), default=best.score) > best.score - LEAST_GAIN:
        return best_of_each([*choices, *found])
    return polished(search, [*choices, *found])

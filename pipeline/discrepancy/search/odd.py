"""What the catalogue has no word of its own for, in place of what mops it up."""

from pipeline.discrepancy.fitting.fit import evaluate, improve
from pipeline.discrepancy.search.choose import (
    LEAST_GAIN,
    Choice,
    Search,
    among,
    best_of_each,
    extended,
)
from pipeline.discrepancy.search.polish import polished
from pipeline.physics.catalogue import ODD


def oddly(search: Search, choices: list[Choice]) -> list[Choice]:
    """The choices (best first), and those with one of ODD in place of all names but one, or of one.

    A search takes other names for what they explain, two or three for each, and no step leads from
    there. It does not begin with them: each comes near what another name does, and would hide it.
    """
    best, ground = choices[0], choices[0].fit.ground
    motion, around = ground.problem.motion, ground.problem.around
    shown = tuple(t for t in ODD if t.excited(motion, around))
    if motion.kinetics is not None or ground.problem.mixed or not shown:
        return choices
    other = among(search, ground.problem, shown)
    one, but_one = ([p] for p in best.fit.pieces), map(best.fit.without, best.fit.pieces)
    kept = {tuple(map(id, rest)): rest for rest in ([], *one, *but_one)}
    found: list[Choice] = []
    for rest in kept.values():
        fit = improve(evaluate(ground, rest))
        found += extended(other, search.weighed(fit, best.place))
    if min((c.score for c in found), default=best.score) > best.score - LEAST_GAIN:
        return best_of_each([*choices, *found])
    return polished(search, [*choices, *found])

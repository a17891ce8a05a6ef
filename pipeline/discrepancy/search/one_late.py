"""One lag or creep in place of two."""

from itertools import combinations

from pipeline.discrepancy.search.choose import excludes
from pipeline.discrepancy.search.exchange import begun_from
from pipeline.discrepancy.search.weighing import Choice, Search
from pipeline.physics.catalogue import ONE_LATE
from pipeline.physics.piece import Piece


def one_late(search: Search, choice: Choice) -> Choice:
    """The choice with one lag or creep in place of two pieces that come late, if that is better.

    What loads the joint bears on what comes late inside the balance, and two that don't, or of
    which each takes the other's part, follow that together; beside either of them the one gains
    nothing.
    """
    found, fit = choice, choice.fit
    problem = fit.ground.problem
    if problem.derivatives is not None:
        return choice
    late = [p for p in fit.pieces if p.term.remembers == "time"]
    shown = [t for t in ONE_LATE if t.excited(problem.motion, problem.around)]
    for gone in combinations(late, 2):
        rest = fit.without(*gone)
        for term in shown:
            if not any(excludes(term, p.term) for p in rest):
                values = term.candidates(problem.motion, problem.around)
                starts = [[*rest, Piece(term, v)] for v in values]
                found = search.better(found, begun_from(fit, starts))
    return found

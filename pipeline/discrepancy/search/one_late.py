"""One lag or creep in place of two."""

from collections.abc import Sequence
from itertools import combinations

from pipeline.discrepancy.fitting.fit import ITERATIONS, Fit, evaluate, improve
from pipeline.discrepancy.search.choose import excludes
from pipeline.discrepancy.search.weighing import Choice, Search
from pipeline.physics.catalogue import ONE_LATE
from pipeline.physics.mechanism import Piece
from pipeline.physics.term import Term

BEGUN, STEPS = 2, 4


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
                found = search.better(found, begun_alone(fit, rest, term))
    return found


def begun_alone(fit: Fit, rest: Sequence[Piece], term: Term) -> Fit:
    """What the best starts of a term beside some pieces of a fit come to."""
    problem = fit.ground.problem
    values = term.candidates(problem.motion, problem.around)
    starts = [evaluate(fit.ground, [*rest, Piece(term, v)]) for v in values]
    starts = sorted(starts, key=lambda f: f.cost)[:BEGUN]
    best = min((improve(f, STEPS) for f in starts), key=lambda f: f.cost)
    return improve(best, 2 * ITERATIONS)

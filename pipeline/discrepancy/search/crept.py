"""A lag of all motion and a zero that moved early: what creep that began at rest may be."""

from pipeline.discrepancy.fitting.fit import Fit, evaluate, improve
from pipeline.discrepancy.search.choose import excludes
from pipeline.discrepancy.search.weighing import Choice, Search
from pipeline.physics.creep import Creep
from pipeline.physics.frame_lag import FrameLag
from pipeline.physics.piece import Piece
from pipeline.physics.response_lag import ResponseLag

FORMS = (Creep("one"), Creep("wire"))
LATE = (ResponseLag.name, FrameLag.name)
BEGUN, FEW = 3, 4


def crept(search: Search, choice: Choice) -> Choice:
    """The choice with creep in place of its lag and of what moves its zero, if that is better.

    Where all steps and waits are alike, slow creep comes late by about as much everywhere, but for
    the first cycle, in which it has not come to that yet: a slip or drift there tells the rest.
    """
    fit = choice.fit
    late = [p for p in fit.pieces if p.term.name in LATE]
    slow = [p for p in fit.pieces if p.term.slow]
    known = any(t.name == Creep.name for t in search.terms)
    if not (late and slow and known):
        return choice
    rest = fit.without(*late, *slow)
    found = choice
    for creep in FORMS:
        key = frozenset((p.term.name, p.term.form) for p in rest) | {(creep.name, creep.form)}
        beside = any(excludes(creep, p.term) for p in rest)
        if not (beside or search.tried_in_vain(key, choice)):
            found = search.best_begun(key, found, begun_with(fit, rest, creep))
    return found


def begun_with(fit: Fit, rest: tuple[Piece, ...], creep: Creep) -> list[Fit]:
    """Creep beside some of a fit's pieces, begun from each time that suits best."""
    problem = fit.ground.problem
    values = creep.candidates(problem.motion, problem.around)
    starts = [evaluate(fit.ground, [*rest, Piece(creep, one)]) for one in values]
    return [improve(f, BEGUN) for f in sorted(starts, key=lambda f: f.cost)[:FEW]]

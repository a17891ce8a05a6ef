"""A damper behind a spring in place of dry friction: one remembers time, the other travel."""

from dataclasses import replace

from pipeline.discrepancy.choose import Choice, Search, best_of_each, choose
from pipeline.discrepancy.polish import polished
from pipeline.discrepancy.problem import Problem
from pipeline.discrepancy.screen import effects_of
from pipeline.physics.catalogue import SPRUNG
from pipeline.physics.term import Term

OF_TRAVEL = ("coulomb_friction", "stribeck_friction")


def sprung(search: Search, choices: list[Choice]) -> list[Choice]:
    """The choices (best first); of a force also those of a damper behind a spring.

    At one speed it is a bristle, so either takes the other's place at the first step of a search
    and no later step leads back: it is looked for without dry friction, and polished with it.
    """
    base = next(c for c in choices if not c.fit.pieces)
    problem = base.fit.ground.problem
    if problem.motion.kinetics is None:
        return choices
    without = tuple(t for t in search.terms if t.name not in OF_TRAVEL)
    found = choose(among(search, problem, (*without, SPRUNG)), base.fit.ground)
    both = best_of_each([*choices, *found])
    if both[0] is choices[0]:
        return both
    return polished(among(search, problem, (*search.terms, SPRUNG)), both)


def among(search: Search, problem: Problem, terms: tuple[Term, ...]) -> Search:
    """The search among other terms."""
    return replace(search, terms=terms, effects=effects_of(problem, terms), vain={})

"""A force's second search: for a lag of all of it, and for what its first search leaves out."""

from dataclasses import replace

from pipeline.discrepancy.fitting.fit import evaluate, improve
from pipeline.discrepancy.fitting.reform import reformed
from pipeline.discrepancy.search.choose import extended
from pipeline.discrepancy.search.excited import further_terms
from pipeline.discrepancy.search.explain import Explanation
from pipeline.discrepancy.search.growth import grown
from pipeline.discrepancy.search.polish import polished
from pipeline.discrepancy.search.weighing import (
    LEAST_GAIN,
    MOST_TERMS,
    Choice,
    Search,
    among,
    best_of_each,
)
from pipeline.physics.catalogue import LATE, SPRUNG
from pipeline.physics.viscous_friction import ViscousFriction

WORTH = 0.5


def searched_again(explanation: Explanation) -> Explanation:
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

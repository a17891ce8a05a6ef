"""The move that terms offer: others in the place of one that may be these in truth."""

from collections.abc import Sequence

from pipeline.discrepancy.fitting.fit import ITERATIONS, Fit, evaluate, improve
from pipeline.discrepancy.fitting.screen import clipped
from pipeline.discrepancy.search.choose import excludes
from pipeline.discrepancy.search.elsewhere import Key, differing
from pipeline.discrepancy.search.growth import grown
from pipeline.discrepancy.search.weighing import MOST_TERMS, Choice, Search
from pipeline.physics.catalogue import instead
from pipeline.physics.piece import Piece

BEGUN, STEPS, HOPED, FARTHER = 3, 4, 100.0, 5.0


def exchanged(search: Search, choice: Choice) -> Choice:
    """The choice with what one of its terms may be instead (`Term.instead`), if that is better."""
    for piece in choice.fit.pieces:
        for key, starts in offered(choice.fit, piece).items():
            if search.tried_in_vain(key, choice):
                continue
            fit = begun_from(choice.fit, starts)
            behind = fit.cost - choice.fit.cost
            if behind < HOPED:
                trial = grown(search, search.weighed(fit, choice.place))
                if trial.score < choice.score:
                    return exchanged(search, trial)
                behind = trial.score - choice.score
            search.vain[key] = choice.score, behind
    return choice


def offered(fit: Fit, piece: Piece) -> dict[Key, list[list[Piece]]]:
    """What may stand in the place of a piece beside the others: starts by the terms taken up."""
    problem = fit.ground.problem
    seen = problem.motion, problem.around
    rest = fit.without(piece)
    found: dict[Key, list[list[Piece]]] = {}
    for told in instead(piece.term, piece.values, *seen):
        new = [Piece(term, clipped(fit, term, values)) for term, values in told]
        fits_in = not any(excludes(n.term, p.term) for n in new for p in rest)
        shown = [t for t in differing([n.term for n in new], fit) if t.excited(*seen)]
        few = len(rest) + len(new) <= max(MOST_TERMS, len(fit.pieces))
        if fits_in and few and len(shown) == len(new):
            key = fit.key | {(n.term.name, n.term.form) for n in new}
            found.setdefault(key, []).append([*rest, *new])
    return found


def begun_from(fit: Fit, starts: Sequence[Sequence[Piece]]) -> Fit:
    """What the best of some starts of the same terms comes to on a fit's ground.

    One that is far behind the fit is left after a few steps.
    """
    fits = sorted((evaluate(fit.ground, s) for s in starts), key=lambda f: f.cost)
    best = min((improve(f, STEPS) for f in fits[:BEGUN]), key=lambda f: f.cost)
    return improve(best, 2 * ITERATIONS) if best.cost < fit.cost + FARTHER * HOPED else best

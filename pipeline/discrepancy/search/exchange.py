"""The move that terms offer: others in the place of one that may be these in truth."""

from collections.abc import Sequence

from pipeline.discrepancy.fitting.fit import ITERATIONS, Fit, evaluate, improve
from pipeline.discrepancy.fitting.screen import clipped
from pipeline.discrepancy.search.choose import MOST_TERMS, Choice, Search, excludes, grown
from pipeline.discrepancy.search.elsewhere import Key, differing
from pipeline.physics.mechanism import Piece

BEGUN, STEPS, HOPED = 3, 4, 100.0


def exchanged(search: Search, choice: Choice) -> Choice:
    """The choice with what one of its terms may be instead (`Term.instead`), if that is better."""
    for piece in choice.fit.pieces:
        for key, starts in offered(choice.fit, piece).items():
            if not search.tried_in_vain(key, choice):
                trial = begun_from(search, choice, starts)
                if trial.score < choice.score:
                    return exchanged(search, trial)
                search.vain[key] = choice.score, trial.score - choice.score
    return choice


def offered(fit: Fit, piece: Piece) -> dict[Key, list[list[Piece]]]:
    """What may stand in the place of a piece beside the others: starts by the terms taken up."""
    problem = fit.ground.problem
    seen = problem.motion, problem.around
    rest = [p for p in fit.pieces if p is not piece]
    found: dict[Key, list[list[Piece]]] = {}
    for told in piece.term.instead(piece.values, *seen):
        new = [Piece(term, clipped(fit, term, values)) for term, values in told]
        fits_in = not any(excludes(n.term, p.term) for n in new for p in rest)
        shown = [t for t in differing([n.term for n in new], fit) if t.excited(*seen)]
        few = len(rest) + len(new) <= max(MOST_TERMS, len(fit.pieces))
        if fits_in and few and len(shown) == len(new):
            key = fit.key | {(n.term.name, n.term.form) for n in new}
            found.setdefault(key, []).append([*rest, *new])
    return found


def begun_from(search: Search, choice: Choice, starts: Sequence[Sequence[Piece]]) -> Choice:
    """What the best of some starts of the same terms comes to; the choice where it is hopeless."""
    fits = sorted((evaluate(choice.fit.ground, s) for s in starts), key=lambda fit: fit.cost)
    best = min((improve(fit, STEPS) for fit in fits[:BEGUN]), key=lambda fit: fit.cost)
    best = improve(best, 2 * ITERATIONS)
    if best.cost > choice.fit.cost + HOPED:
        return choice
    return grown(search, search.weighed(best, choice.place))

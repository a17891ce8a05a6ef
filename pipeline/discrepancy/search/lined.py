"""A wire that rubs all along its sheath in place of a loop and of what stands for its form."""

import numpy as np

from pipeline.discrepancy.fitting.charge import complexity
from pipeline.discrepancy.fitting.fit import ITERATIONS, Fit, evaluate, improve
from pipeline.discrepancy.search.played import PLAY, alone_as_play
from pipeline.discrepancy.search.weighing import Choice, Search
from pipeline.physics.friction import Friction
from pipeline.physics.piece import Piece
from pipeline.physics.sheath_line import SheathLine

BEGUN, FEW = 12, 1
LINE = SheathLine()


def lined(search: Search, choice: Choice) -> Choice:
    """The choice with a wire that rubs all along its sheath in place of its loops, if better.

    Friction whose width grows with the bend comes near that, and slack, a bend or a lag beside it
    nearer still: it is tried without each of them and without all, too.
    """
    fit = choice.fit
    loops = [p for p in fit.pieces if p.term.group == PLAY.group or p.term.name == Friction.name]
    known = any(t.name == Friction.name for t in search.terms)
    key = fit.key | {(LINE.name, LINE.form)}
    if not (loops and known) or LINE.form in {p.term.form for p in loops}:
        return choice
    if search.tried_in_vain(key, choice):
        return choice
    others = fit.without(*loops)
    fewer = [fit.without(*loops, p) for p in others]
    rests = [others, *fewer, *([()] if len(others) > 1 else [])]
    begun = [improve(start, BEGUN) for rest in rests for start in starts_of(fit, rest)]
    best = min(begun, key=lambda f: f.cost + complexity(f))
    found = search.better(choice, improve(best, 2 * ITERATIONS))
    if found is choice:
        search.vain[key] = choice.score, 0.0
    return found


def starts_of(fit: Fit, rest: tuple[Piece, ...]) -> list[Fit]:
    """The likeliest few wires beside a fit's other pieces, as wide as play would be there."""
    ground = fit.ground
    (width,) = alone_as_play(ground, rest).pieces[-1].values
    around = ground.problem.around
    values = LINE.candidates(ground.problem.motion, around)
    rubs = np.unique(values[:, 0])
    own = values[values[:, 0] == rubs[np.argmin(np.abs(rubs - width))]]
    fits = [evaluate(ground, [*rest, Piece(LINE, one)]) for one in own]
    return sorted(fits, key=lambda f: f.cost)[:FEW]

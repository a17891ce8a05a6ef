"""A wire that rubs all along its sheath in place of a loop and of what stands for its form."""

from pipeline.discrepancy.fitting.fit import ITERATIONS, Fit, evaluate, improve
from pipeline.discrepancy.search.played import PLAY
from pipeline.discrepancy.search.weighing import Choice, Search
from pipeline.physics.friction import Friction
from pipeline.physics.piece import Piece
from pipeline.physics.sheath_line import SheathLine

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
    if not (loops and known) or key == fit.key or search.tried_in_vain(key, choice):
        return choice
    others = fit.without(*loops)
    fewer = [fit.without(*loops, p) for p in others]
    rests = [others, *fewer, *([()] if len(others) > 1 else [])]
    return search.best_begun(key, choice, [begun_with(fit, rest) for rest in rests])


def begun_with(fit: Fit, rest: tuple[Piece, ...]) -> Fit:
    """Such a wire beside some of a fit's pieces, begun from what suits best."""
    problem = fit.ground.problem
    values = LINE.candidates(problem.motion, problem.around)
    starts = [evaluate(fit.ground, [*rest, Piece(LINE, one)]) for one in values]
    return improve(min(starts, key=lambda f: f.cost), ITERATIONS)

"""Play whose flanks give, in place of play and what comes late beside it."""

import numpy as np

from pipeline.discrepancy.fitting.fit import ITERATIONS, Fit, evaluate, improve
from pipeline.discrepancy.search.weighing import Choice, Search
from pipeline.physics.backlash import Backlash
from pipeline.physics.catalogue import FLANKS
from pipeline.physics.piece import Piece


def flanked(search: Search, choice: Choice) -> Choice:
    """The choice with play whose flanks give in place of play and a small lag, if that is better.

    Sharp play and a lag of the whole come near it, and hardly any data tell which it is. What comes
    late by more than the noise (RMS) beside play of rigid flanks is told as a lag.
    """
    found, fit = choice, choice.fit
    problem = fit.ground.problem
    if problem.derivatives is not None or not FLANKS.excited(problem.motion, problem.around):
        return choice
    late = [p for p in fit.pieces if p.term.remembers == "time" and p.term.group != FLANKS.group]
    plays = [p for p in fit.pieces if p.term.name == FLANKS.name and p.term.before_curve]
    _, settling = FLANKS.parameters(problem.around)
    for play in plays:
        given = Piece(FLANKS, np.array([play.values[0], settling.start]))
        for lag in (p for p in late if small(fit, play, p)):
            trial = evaluate(fit.ground, [*fit.without(play, lag), given])
            found = search.better(found, improve(trial, 2 * ITERATIONS))
    return found


def small(fit: Fit, play: Piece, lag: Piece) -> bool:
    """Whether a lag explains less than the noise (RMS), play rigid and the others refitted."""
    rigid = Piece(Backlash(), play.values[:1])
    without = improve(evaluate(fit.ground, [*fit.without(play, lag), rigid]))
    return without.mean_square - fit.mean_square < fit.ground.noise.deviation**2

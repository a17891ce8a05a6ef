"""Play that stops its load, and a lag beside it: what play in which the load runs on may be."""

from pipeline.discrepancy.fitting.fit import ITERATIONS, evaluate, improve
from pipeline.discrepancy.search.choose import excludes
from pipeline.discrepancy.search.weighing import MOST_TERMS, Choice, Search
from pipeline.physics.backlash import Backlash
from pipeline.physics.catalogue import LAGS
from pipeline.physics.coasting_play import CoastingPlay
from pipeline.physics.piece import Piece

NARROWER = (1.0, 0.75)
BEGUN = 3


def stopping(search: Search, choice: Choice) -> Choice:
    """The choice with plain play and a lag in place of play in which the load runs on, if better.

    Where a motion has one speed a lag is as much play more, but for the turns, at which it looks
    like a load that runs on. No small step leads from one to the other.
    """
    found, fit, ground = choice, choice.fit, choice.fit.ground
    motion, around = ground.problem.motion, ground.problem.around
    if len(fit.pieces) >= MOST_TERMS:
        return choice
    for play in (p for p in fit.pieces if isinstance(p.term, CoastingPlay)):
        rest = fit.without(play)
        for lag in (t for t in LAGS if t.excited(motion, around)):
            if any(excludes(lag, p.term) for p in rest):
                continue
            starts = [
                evaluate(ground, [*rest, Piece(Backlash(), share * play.values[:1]), Piece(lag, v)])
                for share in NARROWER
                for v in lag.candidates(motion, around)
            ]
            best = min((improve(f, BEGUN) for f in starts), key=lambda f: f.cost)
            found = search.better(found, improve(best, 2 * ITERATIONS))
    return found

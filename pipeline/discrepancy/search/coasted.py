"""A load that runs on in its play, at once: what play and a lag beside it may be instead."""

import numpy as np

from pipeline.discrepancy.fitting.effects import late
from pipeline.discrepancy.fitting.fit import ITERATIONS, evaluate, improve
from pipeline.discrepancy.search.choose import excludes
from pipeline.discrepancy.search.played import PLAY, alone_as_play
from pipeline.discrepancy.search.weighing import Choice, Search
from pipeline.physics.coasting_play import CoastingPlay
from pipeline.physics.piece import Piece

COASTING = CoastingPlay()
WIDER = (1.0, 1.2)
BEGUN = 3


def coasted(search: Search, choice: Choice) -> Choice:
    """The choice with play in which the load runs on in place of play, and of a lag, if better.

    A load that runs on makes up for the more of its play the faster it goes: where a motion slows
    down, play that grows comes near it, and where it swings, play and a lag, or friction. From none
    of these does a small step lead to it.
    """
    found, fit, ground = choice, choice.fit, choice.fit.ground
    motion, around = ground.problem.motion, ground.problem.around
    known = any(t.name == PLAY.name for t in search.terms)
    if not (known and COASTING.excited(motion, around)):
        return choice
    paces = np.unique(COASTING.candidates(motion, around)[:, 1:], axis=0)
    plays = [(p,) for p in fit.pieces if p.term.group == PLAY.group]
    beside = [(*play, other) for play in plays for other in late(fit) if other is not play[0]]
    for gone in (*(p for p in plays if p[0].term.kin != COASTING.kin), *beside):
        rest = fit.without(*gone)
        if any(excludes(COASTING, p.term) for p in rest):
            continue
        (width,) = alone_as_play(ground, rest).pieces[-1].values
        starts = [np.array([w * width, *pace]) for w in WIDER for pace in paces]
        fits = [evaluate(ground, [*rest, Piece(COASTING, start)]) for start in starts]
        best = min((improve(f, BEGUN) for f in fits), key=lambda f: f.cost)
        found = search.better(found, improve(best, 2 * ITERATIONS))
    return found

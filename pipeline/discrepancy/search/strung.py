"""Friction beside a wire that goes on stretching under it: begun together, as neither is alone.

Of both, a loop and what creeps each take half; a wire that stretches under the joint's own pull
alone creeps the wrong way after each reversal, and a friction that does not creep is too wide.
"""

from itertools import product

import numpy as np

from pipeline.discrepancy.fitting.fit import ITERATIONS, evaluate, improve
from pipeline.discrepancy.search.weighing import Choice, Search
from pipeline.physics.backlash import Backlash
from pipeline.physics.friction import Friction
from pipeline.physics.held import STEP_AND_WAIT_S
from pipeline.physics.loaded_wire import LoadedWire
from pipeline.physics.motion import Motion
from pipeline.physics.piece import Piece

WIRE, RUBBING = LoadedWire(), Friction()
BEGUN, STEPS, FURTHER, VARIED = 8, 4, 2, 1.5


def strung(search: Search, choice: Choice) -> list[Choice]:
    """The choice with both in place of its loop and of all that is slow or late, beside the rest.

    They are begun beside noise that does not wander: that would take over what creeps. Not of a
    robot that steps and waits, always as long: a loop each way makes almost any there.
    """
    ground = choice.fit.ground
    motion, around = ground.problem.motion, ground.problem.around
    excited = WIRE.excited(motion, around) and RUBBING.excited(motion, around)
    if not (excited and rests_differ(motion)):
        return []
    loops = (RUBBING.name, Backlash.name)
    kept = [
        p
        for p in choice.fit.pieces
        if not (p.term.slow or p.term.remembers == "time" or p.term.name in loops)
    ]
    still, place = search.stilled(evaluate(ground, kept), choice.place, STEPS)
    rubs = RUBBING.candidates(motion, around)
    starts = product(rubs, WIRE.candidates(motion, around))
    fits = [
        evaluate(still.ground, (*still.pieces, Piece(RUBBING, rub), Piece(WIRE, yields)))
        for rub, yields in starts
    ]
    few = sorted(fits, key=lambda f: f.cost)[:BEGUN]
    fewer = sorted((improve(f, STEPS) for f in few), key=lambda f: f.cost)[:FURTHER]
    best = min((improve(f, 2 * ITERATIONS) for f in fewer), key=lambda f: f.cost)
    return [search.weighed(best, place)]


def rests_differ(motion: Motion) -> bool:
    """Whether a command rests so differently long, or so short, that time tells from the way."""
    shortest, longest = np.quantile(motion.stood_s, (0.05, 0.95))
    return bool(longest > VARIED * shortest or motion.usual_dwell_s < STEP_AND_WAIT_S)

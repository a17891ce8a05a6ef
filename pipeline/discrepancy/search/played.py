"""Uneven play at once: what a loop and a dent beside it may be instead."""

from collections.abc import Sequence
from itertools import combinations, product

from pipeline.discrepancy.fitting.effects import late
from pipeline.discrepancy.fitting.fit import Fit, evaluate, improve
from pipeline.discrepancy.fitting.ground import Ground
from pipeline.discrepancy.fitting.reform import reformed
from pipeline.discrepancy.search.choose import excludes
from pipeline.discrepancy.search.moves import curves
from pipeline.discrepancy.search.weighing import Choice, Search
from pipeline.physics.backlash import Backlash
from pipeline.physics.piece import Piece
from pipeline.physics.uneven_play import FORMS, UnevenPlay

PLAY = Backlash()
BEGUN = 3


def played(search: Search, choice: Choice) -> Choice:
    """The choice with play whose width goes with the pose in place of one or two, if better.

    Where play is wider round home, friction or a lag beside slack comes near it, or slack beside
    friction that is there as well; play of one width is no step on the way from these to it.
    """
    found, ground = choice, choice.fit.ground
    motion, around = ground.problem.motion, ground.problem.around
    forms = [f for f in map(UnevenPlay, FORMS) if f.excited(motion, around)]
    if not (forms and any(t.name == PLAY.name for t in search.terms)):
        return choice
    behind = late(choice.fit)
    bent = [p for p in choice.fit.pieces if curves(p.term)]
    for gone in (*combinations(behind, 1), *combinations(bent, 1), *product(behind, bent)):
        rest = choice.fit.without(*gone)
        if any(excludes(PLAY, p.term) for p in rest):
            continue
        plain = alone_as_play(ground, rest)
        trials = [reformed(plain, len(rest), form) for form in forms]
        best = min(trials, key=lambda t: search.hoped(t, choice.place))
        found = search.better(found, best)
    return found


def alone_as_play(ground: Ground, rest: Sequence[Piece]) -> Fit:
    """Some pieces and play of one width, which goes last, after a few steps."""
    motion, around = ground.problem.motion, ground.problem.around
    starts = [Piece(PLAY, v) for v in PLAY.candidates(motion, around)]
    return improve(min((evaluate(ground, [*rest, s]) for s in starts), key=lambda f: f.cost), BEGUN)

"""A wire that rubs ahead of all that loads the joint, at once: what a loop may be instead."""

from pipeline.discrepancy.fitting.fit import ITERATIONS, evaluate, improve
from pipeline.discrepancy.search.played import PLAY, alone_as_play
from pipeline.discrepancy.search.weighing import Choice, Search
from pipeline.physics.friction import Friction
from pipeline.physics.piece import Piece
from pipeline.physics.rubbing_wire import RUBBING
from pipeline.physics.slack import Slack

BEGUN = 3


def rubbed(search: Search, choice: Choice) -> Choice:
    """The choice with wire friction ahead of what hangs slack or loads the joint, if better.

    Friction at the joint holds it where they would move it. Where the wire rubs before, play comes
    nearer, with corners that are too sharp, and play that grows with round ones nearer still.
    """
    fit, ground = choice.fit, choice.fit.ground
    loops = [p for p in fit.pieces if p.term.group == PLAY.group or p.term.name == Friction.name]
    rest = fit.without(*loops)
    known = any(t.name == Friction.name for t in search.terms)
    tried = any(p.term.form == t.form for p in loops for t in RUBBING)
    loaded = any(p.term.in_balance or p.term.name == Slack.name for p in rest)
    if tried or not (known and loops and loaded):
        return choice
    (width,) = alone_as_play(ground, rest).pieces[-1].values
    starts = [Piece(term, values) for term in RUBBING for values in term.as_wide(width)]
    fits = [improve(evaluate(ground, [*rest, start]), BEGUN) for start in starts if width > 0.0]
    if not fits:
        return choice
    return search.better(choice, improve(min(fits, key=lambda f: f.cost), 2 * ITERATIONS))

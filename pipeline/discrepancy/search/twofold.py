"""Friction of two kinds at once: a wire that rubs in its sheath, and a joint that does."""

from collections.abc import Iterator

import numpy as np

from pipeline.discrepancy.fitting.fit import Fit, evaluate, improve
from pipeline.discrepancy.search.weighing import Choice, Search
from pipeline.physics.driven_bank import DrivenBank
from pipeline.physics.friction import Friction
from pipeline.physics.piece import Piece
from pipeline.physics.term import Term

BEGUN = 4
SHARES = ((0.7, 1.0, 0.3, 0.5), (0.3, 0.5, 0.7, 1.0))
JOINT, SHEATH = Friction(), DrivenBank()


def twofold(search: Search, choice: Choice) -> Choice:
    """The choice with friction at the joint and in the sheath in place of one of them, if better.

    One distribution of slip elements may be too narrow for all that rubs. What it leaves, a creep,
    a lag or play takes over: each other term is tried without, too.
    """
    own = [p for p in choice.fit.pieces if isinstance(p.term, Friction)]
    angle = choice.fit.ground.problem.derivatives is None
    key = choice.fit.key | {(JOINT.name, JOINT.form), (SHEATH.name, SHEATH.form)}
    if len(own) != 1 or not angle or search.tried_in_vain(key, choice):
        return choice
    begun = [improve(start, BEGUN) for start in starts_of(choice.fit, own[0])]
    return search.best_begun(key, choice, begun)


def starts_of(fit: Fit, own: Piece) -> Iterator[Fit]:
    """Friction at both places beside a fit's other pieces, and beside all but one of them."""
    around = fit.ground.problem.around
    slope = around.angle_span / max(around.drive_span, 1e-300)
    width, reach = own.values[:2] * (slope if own.term.before_curve else 1.0)
    others = fit.without(own)
    rests = [others, *(fit.without(own, p) for p in others)]
    for rest in rests:
        for at_joint, near, in_sheath, far in SHARES:
            joint = np.array([at_joint * width, near * reach, 0.5])
            sheath = np.array([in_sheath * width / slope, far * reach / slope, 1.0])
            both = (inside(fit, JOINT, joint), inside(fit, SHEATH, sheath))
            yield evaluate(fit.ground, [*rest, *both])


def inside(fit: Fit, term: Term, values: np.ndarray) -> Piece:
    """A piece with values within its bounds."""
    box = fit.ground.box(term)
    return Piece(term, np.clip(values, box.low, box.high))

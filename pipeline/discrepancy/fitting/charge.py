"""What an explanation is charged for its terms, beside what it leaves."""

from math import log

import numpy as np

from pipeline.discrepancy.fitting.calibration import FAR_OFF, absurd_gain
from pipeline.discrepancy.fitting.fit import Fit, parameters_of
from pipeline.discrepancy.fitting.ground import Ground
from pipeline.number_words import worded

TERM_COST = 8.0
SECOND_SIDE = 1.0
AT_BOUND = 1.0
VOID, NEVER = 40.0, 1e4


def complexity(fit: Fit) -> float:
    """The charge for a fit's terms and for those of their parameters that are not at a bound.

    Each moment of a term is an event of its own: a second slip is as unlikely as the first. A
    calibration that can be none explains as little as a term that amounts to nothing; so does a
    slip before the first sample used, which is another home of a curve that bends. What a plainer
    form tells is told so.
    """
    first_s = fit.ground.problem.motion.time_s[int(np.argmax(fit.ground.used))]
    around, motion = fit.ground.problem.around, fit.ground.problem.motion
    charge, each = 0.0 if absurd_calibration(fit) is None else VOID, log(independent(fit.ground))
    for i, piece in enumerate(fit.pieces):
        charge += VOID if piece.term.void(piece.values) else 0.0
        charge += NEVER if piece.term.slight(piece.values, around) else 0.0
        again = piece.term.side != 0.0 and piece.term.name in fit.names[:i]
        own = (SECOND_SIDE if again else TERM_COST) + piece.term.unlikely
        parameters = parameters_of(fit.ground, piece.term)
        charge += own * max(sum(p.moment for p in parameters), 1)
        charge += piece.term.chance(piece.values, motion)
        for p, value in zip(parameters, piece.values, strict=True):
            charge += VOID if p.moment and value <= first_s else 0.0
            nothing = p.weak or (value <= p.low and p.typical > 0.0)
            charge += AT_BOUND if nothing else each
    return charge


def absurd_calibration(fit: Fit) -> str | None:
    """Which part of the calibration no calibration can be, in words.

    A gain that is off by a factor of two, or turned round, speaks of units or wiring; an offset
    beyond all that the simulation moves, too, in the middle of that: at a zero that is far from
    there, each gain has an offset of its own.
    """
    around = fit.ground.problem.around
    gain, offset = fit.nuisance[:2]
    problem = fit.ground.problem
    turned = gain <= 0.0 and problem.derivatives is None
    if turned or absurd_gain(float(gain), problem.tolerance):
        return f"the gain, which is {worded(gain)}"
    middle = around.angle_low + 0.5 * around.angle_span
    there = offset + (gain - 1.0) * middle
    if abs(there) > max(around.angle_span, FAR_OFF * fit.ground.problem.tolerance.offset):
        return f"the offset, which is {worded(offset)} {around.angle_unit}"
    return None


def independent(ground: Ground) -> float:
    """About how many independent samples there are."""
    share = ground.noise.correlated**2 / max(ground.noise.deviation**2, 1e-300)
    phi = ground.noise.correlation
    count = ground.count / ground.noise.spell
    return max(count * (1.0 - share * 2.0 * phi / (1.0 + phi)), 10.0)

"""Moments: parameters that act between two samples are tried sample by sample."""

import numpy as np

from pipeline.discrepancy.fit import Fit, evaluate, improve
from pipeline.physics.mechanism import Piece

STRIDES = (4, 1)
TRIED = 6


def settle_moments(fit: Fit) -> Fit:
    """The fit with the moment of a slip moved to the fitted sample before which it fits best."""
    for i, piece in enumerate(fit.pieces):
        if piece.term.name != "lost_steps":
            continue
        times = moments(fit)
        for stride in STRIDES:
            near = int(np.argmin(np.abs(times - fit.pieces[i].values[1])))
            places = range(
                max(near - stride * TRIED, 0), min(near + stride * TRIED + 1, len(times)), stride
            )
            best = min((moved(fit, i, times[k]) for k in places), key=lambda t: t.cost)
            if best.cost < fit.cost:
                fit = improve(best, 3)
    return fit


def moments(fit: Fit) -> np.ndarray:
    """Times halfway between neighbouring fitted samples: others tell no moments apart [s]."""
    time_s = fit.ground.problem.motion.time_s[fit.ground.used]
    return 0.5 * (time_s[1:] + time_s[:-1])


def moved(fit: Fit, place: int, moment_s: float) -> Fit:
    """The fit with the moment of one of its terms elsewhere."""
    values = fit.pieces[place].values.copy()
    values[1] = moment_s
    pieces = (
        *fit.pieces[:place],
        Piece(fit.pieces[place].term, values),
        *fit.pieces[place + 1 :],
    )
    return evaluate(fit.ground, pieces)

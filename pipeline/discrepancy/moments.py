"""Moments: parameters that act between two samples are tried sample by sample."""

import numpy as np

from pipeline.discrepancy.fit import Fit, evaluate, improve
from pipeline.physics.mechanism import Piece

REACH = 16


def settle_moments(fit: Fit) -> Fit:
    """The fit with the moment of a slip moved to the sample where it fits best."""
    for i, piece in enumerate(fit.pieces):
        if piece.term.name != "lost_steps":
            continue
        time_s = fit.ground.problem.motion.time_s
        for reach in (REACH, 2):
            row = int(np.searchsorted(time_s, fit.pieces[i].values[1]))
            stride = max(reach // 8, 1)
            rows = range(max(row - reach, 1), min(row + reach + 1, len(time_s)), stride)
            trials = [moved(fit, i, 0.5 * (time_s[r] + time_s[r - 1])) for r in rows]
            best = min(trials, key=lambda t: t.cost)
            if best.cost < fit.cost:
                fit = improve(best, 3)
    return fit


def moved(fit: Fit, place: int, moment_s: float) -> Fit:
    values = fit.pieces[place].values.copy()
    values[1] = moment_s
    pieces = (
        *fit.pieces[:place],
        Piece(fit.pieces[place].term, values),
        *fit.pieces[place + 1 :],
    )
    return evaluate(fit.ground, pieces)

"""Moments: parameters that act between two samples are tried sample by sample."""

import numpy as np

from pipeline.discrepancy.fitting.fit import Fit, evaluate, improve, parameters_of
from pipeline.physics.piece import Piece

STRIDES = (4, 1)
TRIED = 6
LAST_UNSEEN = 12


def settle_moments(fit: Fit) -> Fit:
    """The fit with each moment of a slip moved to the sample before which it fits best."""
    for i, piece in enumerate(fit.pieces):
        for j in moments_of(fit, piece):
            times = moments(fit)
            for stride in STRIDES:
                fit = moved_on(fit, i, j, times, stride)
            fit = moved_unseen(fit, i, j)
    return in_order(fit)


def moved_unseen(fit: Fit, place: int, parameter: int) -> Fit:
    """The fit with a moment among the LAST_UNSEEN rows not fitted that end nearby, if better.

    What comes late or remembers its way still tells there how long before the first row fitted it
    was; what does neither, fits as well anywhere among them.
    """
    used, time_s = fit.ground.used, fit.ground.problem.motion.time_s
    ends = np.flatnonzero(used[1:] & ~used[:-1]) + 1
    at = int(np.searchsorted(time_s, fit.pieces[place].values[parameter]))
    rows = np.flatnonzero(used)
    own = np.searchsorted(rows, at)
    ends = ends[np.abs(np.searchsorted(rows, ends) - own) <= TRIED]
    if not len(ends):
        return fit
    trials = [
        moved(fit, place, parameter, 0.5 * (time_s[k] + time_s[k - 1]))
        for end in ends
        for k in range(end, max(end - LAST_UNSEEN, 0), -1)
        if not used[k - 1]
    ]
    best = min(trials, key=lambda t: t.cost)
    return improve(best, 3) if best.cost < fit.cost else fit


def moved_on(fit: Fit, place: int, parameter: int, times_s: np.ndarray, stride: int) -> Fit:
    """The fit with a moment some strides on among times (n,), if that fits better.

    Up to TRIED strides are tried, but no more than one where that makes the fit worse either way.
    """
    near = int(np.argmin(np.abs(times_s - fit.pieces[place].values[parameter])))
    for strides in (1, TRIED):
        first, last = near - stride * strides, near + stride * strides
        places = range(max(first, 0), min(last + 1, len(times_s)), stride)
        trials = (moved(fit, place, parameter, times_s[k]) for k in places)
        best = min(trials, key=lambda t: t.cost)
        if best.cost >= fit.cost:
            return fit
    return improve(best, 3)


def in_order(fit: Fit) -> Fit:
    """The fit with the slips of one piece told in the order of their times."""
    pieces = list(fit.pieces)
    for i, piece in enumerate(pieces):
        pairs = piece.values.reshape(-1, 2) if len(moments_of(fit, piece)) > 1 else piece.values[:0]
        if len(pairs) and np.any(np.diff(pairs[:, 1]) < 0.0):
            pieces[i] = Piece(piece.term, pairs[np.argsort(pairs[:, 1])].ravel())
    swapped = any(new is not old for new, old in zip(pieces, fit.pieces, strict=True))
    return evaluate(fit.ground, pieces) if swapped else fit


def moments_of(fit: Fit, piece: Piece) -> list[int]:
    """Which of a piece's parameters are moments."""
    return [j for j, p in enumerate(parameters_of(fit.ground, piece.term)) if p.moment]


def moments(fit: Fit) -> np.ndarray:
    """Times halfway between neighbouring fitted samples: others tell no moments apart [s]."""
    time_s = fit.ground.problem.motion.time_s[fit.ground.used]
    return 0.5 * (time_s[1:] + time_s[:-1])


def moved(fit: Fit, place: int, parameter: int, moment_s: float) -> Fit:
    """The fit with a moment (`parameter`) of one of its terms elsewhere."""
    values = fit.pieces[place].values.copy()
    values[parameter] = moment_s
    pieces = (
        *fit.pieces[:place],
        Piece(fit.pieces[place].term, values),
        *fit.pieces[place + 1 :],
    )
    return evaluate(fit.ground, pieces)

"""Frames from a queue at once: what comes late by more and more until it is not, again and again.

A mean lag, play or friction takes half of it; from that no step leads to the queue's rhythm.
"""

from collections.abc import Iterable

import numpy as np
from numba import njit
from scipy.optimize import minimize

from pipeline.discrepancy.fitting.effects import late
from pipeline.discrepancy.fitting.fit import (
    Fit,
    calibrated,
    evaluate,
    improve,
    respond_beside,
)
from pipeline.discrepancy.search.choose import excludes
from pipeline.discrepancy.search.weighing import Choice, Search
from pipeline.physics.catalogue import QUEUE
from pipeline.physics.frame_lag import FrameLag
from pipeline.physics.piece import Piece
from pipeline.physics.queued_frames import LONGEST, SHORTEST

COARSE, FINE = (24, 0.2), (120, 0.02)
BEGUN, TRIED, PROMISES, LAGGARD = 4, 100, 40.0, 0.3
RISES, FLOORS = (0.5, 0.7, 1.0, 1.3), (0.0, 0.15, 0.3, 0.6, 1.0)
WAYS = (1.0, -1.0, 3.0)


def queued(search: Search, choice: Choice) -> Choice:
    """The choice with frames from a queue in place of what comes late, if that is better.

    In place of one such thing, of all and of what moves the zero, or of a whole pile that mops up.
    Where rows are picked of more samples, the rhythm of these isn't known. Whatever took a queue's
    place leaves some of its rhythm.
    """
    found, problem, pieces = choice, choice.fit.ground.problem, choice.fit.pieces
    known = any(t.name == FrameLag.name for t in search.terms)
    if problem.picked is not None or not (known and QUEUE.excited(problem.motion, problem.around)):
        return choice
    behind = late(choice.fit)
    if not (any(p.term.form == QUEUE.form for p in behind) or (behind and rhythmic(choice.fit))):
        return choice
    mopping = [p for p in pieces if p.term.slow or any(p is b for b in behind)]
    piles = [p for p in (mopping, pieces) if len(p) > 1] if behind else []
    for gone in (*([p] for p in behind), *piles):
        rest = choice.fit.without(*gone)
        if any(excludes(QUEUE, p.term) for p in rest):
            continue
        fit = evaluate(choice.fit.ground, rest)
        if [p.term.form for p in gone] == [QUEUE.form]:
            found = search.better(found, settled(fit, gone[0].values, np.inf))
        few, gain = rhythms(fit)
        told = fit.cost - choice.fit.cost
        if gain > told + PROMISES:
            most = choice.fit.cost + LAGGARD * told
            trials = [settled(fit, values, most) for values in refined(fit, few)]
            best = min(trials, key=lambda t: t.cost)
            found = search.better(found, improve(best, 8)) if best.cost < most else found
    return found


def rhythmic(fit: Fit) -> bool:
    """Whether what a fit leaves comes late by more and more until it does not, at some pace."""
    most = max(row[-1] for row in coarsely_folded(fit))
    return most > PROMISES * fit.ground.noise.deviation**2


def rhythms(fit: Fit) -> tuple[list[list[float]], float]:
    """The likeliest queues beside a fit, as `folded`, and what the first explains [noise]."""
    few = coarsely_folded(fit)[:BEGUN]
    return few, few[0][0] / fit.ground.noise.deviation**2


def coarsely_folded(fit: Fit) -> list[list[float]]:
    """The best queue of each of all periods that one may have."""
    count, (parts, apart) = len(fit.predicted), COARSE
    return folded(fit, np.arange(count / LONGEST, count / SHORTEST, apart), parts)


def refined(fit: Fit, few: list[list[float]]) -> np.ndarray:
    """Parameters of queues (k, 4) whose periods are near those of some, found on a finer grid."""
    parts, apart = FINE
    near = np.arange(-COARSE[1], COARSE[1], apart)
    best = [folded(fit, len(fit.predicted) / row[2] + near, parts)[0][1:-1] for row in few]
    box = fit.ground.box(QUEUE)
    return np.clip(np.unique(best, axis=0), box.low, box.high)


def folded(fit: Fit, often: Iterable[float], parts: int) -> list[list[float]]:
    """Gain, rise, period, turn, floor of the best queue of each frequency, the best first.

    Last in each row: the part of the gain that is not a steady lag's.

    A frame that is late by l samples is off by about -l times the step to its pose. Folded by a
    period, the lags of each of some parts of it are regressed, by weighted least squares, on a
    sawtooth that begins anew at one of these parts. often: periods in the whole recording.
    """
    ground, predicted = fit.ground, fit.predicted
    step = np.diff(predicted, prepend=predicted[:1])
    off = ground.problem.measured - predicted
    rows = np.flatnonzero(ground.used & np.isfinite(off) & (step != 0.0))
    weight, moved = step[rows] ** 2, -off[rows] * step[rows]
    return sorted(
        [*_sawtooth(rows, weight, moved, frequency, parts)]
        for frequency in np.asarray(often) / len(step)
    )[::-1]


@njit(cache=True, error_model="numpy")
def _sawtooth(rows, weight, moved, frequency, parts):  # type: ignore[no-untyped-def]
    """The best queue of a frequency [1/row], as a row of `folded`; weight, moved: of each row."""
    w, y = np.zeros(parts), np.zeros(parts)
    for i in range(rows.size):
        part = int(rows[i] * frequency % 1.0 * parts)
        w[part] += weight[i]
        y[part] += moved[i]
    every, all_moved = max(w.sum(), 1e-300), y.sum()
    best, rise, mean, gain = 0, 0.0, 0.0, -1.0
    for begin in range(parts):
        first, second, along = 0.0, 0.0, 0.0
        for k in range(parts):
            saw = (k + 0.5 - begin) % parts / parts
            first += saw * w[k] / every
            second += saw * saw * w[k]
            along += saw * y[k]
        spread = max(second - first * first * every, 1e-12 * every)
        steep = (along - first * all_moved) / spread
        gained = steep * steep * spread if steep > 0.0 else 0.0
        if gained > gain:
            best, rise, mean, gain = begin, steep, first, gained
    lag = all_moved / every
    floor = max((lag - rise * mean) / max(rise, 1e-9), 0.0)
    return gain + lag * lag * every, rise, 1.0 / frequency, 1.0 - best / parts, floor, gain


def settled(fit: Fit, values: np.ndarray, most: float) -> Fit:
    """The fit with a queue besides, in the rhythm of some parameters, (4,).

    Whole frames have no slopes: by the simplex (Nelder and Mead, Computer J. 7 (1965) 308), begun
    there or from a shape that is better, and again from where it ended. A cost above `most` after
    the first time is left at that.
    """
    box, (rise, every, turn, _) = fit.ground.box(QUEUE), values

    def tried(v: np.ndarray) -> Fit:
        pieces = (*fit.pieces, Piece(QUEUE, np.clip(v, box.low, box.high)))
        return calibrated(fit.ground, pieces, respond_beside(fit, pieces, QUEUE))

    shapes = [values, *([rise * r, every, turn, floor] for r in RISES for floor in FLOORS)]
    best = min((tried(np.array(shape)) for shape in shapes), key=lambda t: t.cost)
    sizes = np.diag([0.3, 0.02 * every**2 / len(fit.predicted), 0.01, 0.1])
    for way in WAYS:
        start = best.pieces[-1].values
        simplex = np.vstack([start, start + way * sizes])
        options = {"initial_simplex": simplex, "maxfev": TRIED, "xatol": 1e-3, "fatol": 0.5}
        found = minimize(lambda v: tried(v).cost, start, method="Nelder-Mead", options=options)
        best = min(best, tried(found.x), key=lambda t: t.cost)
        if best.cost > most:
            break
    return best

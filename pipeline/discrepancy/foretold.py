"""What each explanation foretells of later training rows, where no cycle repeats another."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pipeline.discrepancy.choose import Choice, complexity, independent
from pipeline.discrepancy.fit import Fit, Ground, evaluate, improve
from pipeline.discrepancy.ties import TIE
from pipeline.physics.mechanism import Piece

CUTS = (0.55, 0.75)
AHEAD = 0.25
NEAR, MOST = 25.0, 8
NEEDED, ENOUGH = 0.1, 0.7
FEWEST_ROWS = 20


def foretelling(choices: Sequence[Choice]) -> list[Choice]:
    """The choices with what they foretell in their scores, the best first, then by score.

    Without repeats the size of the noise is no witness, and what fits best may be what follows a
    slow change best. So the choices near the best one are refitted to the first part of the
    training rows and have to foretell the next part; n log(error^2 / least error^2) is added to
    their scores, n being the number of independent samples foretold (prequential validation,
    Dawid, J. R. Stat. Soc. A 147 (1984) 278). Of those that tie, the best is what foretells best.
    """
    ranked = sorted(choices, key=lambda c: c.score)
    near = [c for c in ranked if c.score < ranked[0].score + NEAR][:MOST]
    rows = np.flatnonzero(ranked[0].fit.ground.used)
    if len(near) < 2 or AHEAD * len(rows) < FEWEST_ROWS:
        return ranked
    errors = np.array([error_ahead(c, rows) for c in near])
    count = len(CUTS) * AHEAD * independent(near[0].fit.ground)
    extra = count * 2.0 * np.log(errors / errors.min())
    weighed = [replace(c, score=c.score + float(e)) for c, e in zip(near, extra, strict=True)]
    least = min(c.score for c in weighed)
    tied = [k for k, c in enumerate(weighed) if c.score < least + TIE]
    best = weighed[min(tied, key=lambda k: errors[k])]
    others = [c for c in (*weighed, *ranked) if c is not best and all(c is not n for n in near)]
    return [best, *sorted(others, key=lambda c: c.score)]


def foretold_part(choices: Sequence[Choice], choice: Choice, structured: bool) -> Choice:
    """What of a choice later training rows bear out, where nothing repeats.

    A name stays whose absence would raise the mean square error ahead above the least so far; the
    rest is refitted. Where a structured rest is left it has to be by a tenth, and all go where what
    stays takes away less than seven tenths of what calibration alone leaves.
    """
    base = next(c for c in choices if not c.fit.pieces)
    rows = np.flatnonzero(choice.fit.ground.used)
    needed = 1.0 + (NEEDED if structured else 0.0)
    left = error_ahead(choice, rows) ** 2
    while choice.fit.pieces:
        trials = [_without(choice, name) for name in dict.fromkeys(choice.fit.names)]
        errors = [error_ahead(t, rows) ** 2 for t in trials]
        k = int(np.argmin(errors))
        if errors[k] > needed * left:
            break
        choice, left = trials[k], min(left, errors[k])
    if not structured:
        return choice
    whole = error_ahead(base, rows) ** 2
    enough = error_ahead(choice, rows) ** 2 < (1.0 - ENOUGH) * whole
    return choice if choice.fit.pieces and enough else base


def _without(choice: Choice, name: str) -> Choice:
    rest = [p for p in choice.fit.pieces if p.term.name != name]
    return replace(choice, fit=improve(evaluate(choice.fit.ground, rest)))


def called_for(ground: Ground, pieces: Sequence[Piece]) -> Fit:
    """Pieces refitted, without each slip that does not lower the cost by what it is charged."""
    fit = improve(evaluate(ground, pieces))
    for piece in pieces:
        if any(p.stepwise for p in piece.term.parameters(ground.problem.around)):
            rest = [p for p in fit.pieces if p.term is not piece.term]
            without = improve(evaluate(ground, rest))
            if without.cost + complexity(without) < fit.cost + complexity(fit):
                fit = without
    return fit


def error_ahead(choice: Choice, rows: np.ndarray) -> float:
    """Root mean square error [measurement's unit] on rows after those that it is refitted to.

    A slip that those do not call for is left out: its moment was found by what came later.
    """
    ground, square, count = choice.fit.ground, 0.0, 0
    measured = ground.problem.measured
    for cut in CUTS:
        first = int(cut * len(rows))
        ahead = rows[first : first + int(AHEAD * len(rows))]
        early = np.zeros(len(ground.used), dtype=bool)
        early[rows[:first]] = True
        fit = called_for(replace(ground, used=early), choice.fit.pieces)
        square += float(np.sum((measured - fit.predicted)[ahead] ** 2))
        count += len(ahead)
    return max(float(np.sqrt(square / count)), 1e-300)

"""What each explanation foretells of later training rows, where no cycle repeats another."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from pipeline.discrepancy.fitting.charge import complexity, independent
from pipeline.discrepancy.fitting.fit import Fit, evaluate, improve
from pipeline.discrepancy.fitting.ground import Ground
from pipeline.discrepancy.search.weighing import TIE, Choice, names
from pipeline.physics.lost_steps import LostSteps
from pipeline.physics.piece import Piece

CUTS = (0.55, 0.75)
AHEAD = 0.25
NEAR, MOST = 25.0, 8
NEEDED, ENOUGH, FAR_MORE = 0.1, 0.7, 25.0
ONE_SLIP = 2  # parameters: its jump and its time
FEWEST_ROWS = 20


@dataclass(frozen=True)
class Part:
    """early: (n,) mask of the rows that are fitted. ahead: rows (indices) that are foretold."""

    early: np.ndarray
    ahead: np.ndarray


def foretelling(choices: Sequence[Choice]) -> list[Choice]:
    """The choices with what they foretell in their scores, the best first, then by score.

    Without repeats the size of the noise is no witness, and what fits best may be what follows a
    slow change best. So the choices near the best one are refitted to the first part of the
    training rows and have to foretell the next part; n log(error^2 / least error^2) is added to
    their scores, n being the number of independent samples foretold (prequential validation,
    Dawid, J. R. Stat. Soc. A 147 (1984) 278). At most it settles a tie: the scores know those rows.
    """
    ranked = sorted(choices, key=lambda c: c.score)
    near = [c for c in ranked if c.score < ranked[0].score + NEAR][:MOST]
    parts = parts_of(ranked[0].fit.ground)
    if len(near) < 2 or not testable(ranked[0]):
        return ranked
    errors = np.array([error_ahead(c, parts) for c in near])
    counts = np.array([errors_ahead(c, parts) for c in near])
    extra = np.minimum(counts * 2.0 * np.log(errors / least_errors(near, errors)), TIE)
    weighed = [replace(c, score=c.score + float(e)) for c, e in zip(near, extra, strict=True)]
    return sorted([*weighed, *ranked[len(near) :]], key=lambda c: c.score)


def errors_ahead(choice: Choice, parts: Sequence[Part]) -> float:
    """How many errors ahead are independent by a choice's own noise.

    Those of a cycle share its zero, where that jitters: then so many of them say as much as one
    (design effect, Kish, Survey Sampling (1965)).
    """
    ground, rows = choice.fit.ground, rows_ahead(parts)
    cycles = sum(len(np.unique(ground.problem.cycle[part.ahead])) for part in parts)
    zero, own = ground.noise.jitter**2, ground.noise.deviation**2
    count = independent(ground) * rows / max(ground.count, 1)
    alike = (count / max(cycles, 1) - 1.0) * zero / max(zero + own, 1e-300)
    return count / (1.0 + max(alike, 0.0))


def least_errors(choices: Sequence[Choice], errors: np.ndarray) -> np.ndarray:
    """The least error (k,) of the choices that have no more names than each.

    Whether one name more earns its place is for the scores to say, which charge for it: the rows
    ahead are a part of those that they know, and would count twice. But noise that walks foretells
    nothing: a slow name more may be what it hides.
    """
    least = []
    for choice in choices:
        walks, most = choice.place[2] > 0, len(names(choice))
        fair = [len(names(c) - c.fit.slow if walks else names(c)) <= most for c in choices]
        least.append(float(errors[fair].min()))
    return np.array(least)


def foretold_part(choices: Sequence[Choice], choice: Choice, rest: float) -> Choice:
    """What of a choice that leaves a structured rest later training rows bear out.

    Slips go at once: beside a rest that is not understood, a zero that jumps follows just that. But
    one that explains far more than the rest (its mean square) is a slip: it stays, and no row ahead
    is asked for it. A name stays whose absence would raise the mean square error ahead by a tenth
    of the least so far; the rest is refitted. All others go where what stays takes away less than
    seven tenths of what is left without.
    """
    base = next(c for c in choices if not c.fit.pieces)
    parts = parts_of(choice.fit.ground)
    sure = sure_slips(choice, rest)
    if LostSteps.name in choice.fit.names and not sure:
        choice = choice.but_for(LostSteps.name)
    left = error_ahead(choice, parts, sure) ** 2
    while others := [n for n in dict.fromkeys(choice.fit.names) if not sure or n != LostSteps.name]:
        trials = [choice.but_for(name) for name in others]
        errors = [error_ahead(t, parts, sure) ** 2 for t in trials]
        k = int(np.argmin(errors))
        if errors[k] > (1.0 + NEEDED) * left:
            break
        choice, left = trials[k], min(left, errors[k])
    alone = replace(choice, fit=evaluate(choice.fit.ground, sure)) if sure else base
    whole = error_ahead(alone, parts, sure) ** 2
    enough = error_ahead(choice, parts, sure) ** 2 < (1.0 - ENOUGH) * whole
    return choice if len(choice.fit.pieces) > len(sure) and enough else alone


def sure_slips(choice: Choice, rest: float) -> list[Piece]:
    """The one slip of a choice, if it explains FAR_MORE of the mean square than a rest is."""
    slips = [p for p in choice.fit.pieces if isinstance(p.term, LostSteps)]
    if sum(len(p.values) for p in slips) != ONE_SLIP:
        return []
    without = improve(evaluate(choice.fit.ground, choice.fit.without(*slips)))
    return slips if without.mean_square - choice.fit.mean_square > FAR_MORE * rest else []


def called_for(ground: Ground, pieces: Sequence[Piece], sure: Sequence[Piece]) -> Fit:
    """Pieces refitted, without each slip that does not lower the cost by what it is charged.

    sure: slips that stay as they are, whether the rows fitted say anything of them or not.
    """
    known = {id(p.term): p for p in sure}
    fit = improve(evaluate(ground, pieces))
    for piece in pieces:
        moments = any(p.moment for p in piece.term.parameters(ground.problem.around))
        if moments and id(piece.term) not in known:
            rest = [p for p in fit.pieces if p.term is not piece.term]
            without = improve(evaluate(ground, rest))
            if without.cost + complexity(without) < fit.cost + complexity(fit):
                fit = without
    if not known:
        return fit
    return evaluate(ground, [known.get(id(p.term), p) for p in fit.pieces])


def parts_of(ground: Ground) -> list[Part]:
    """What is fitted and what is foretold, for each cut; only where the drive has been before.

    What a mechanism does beyond the range that was fitted says nothing of how it changes.
    """
    rows, drive, out = np.flatnonzero(ground.used), ground.problem.motion.drive, []
    for cut in CUTS:
        first = int(cut * len(rows))
        early = np.zeros(len(ground.used), dtype=bool)
        early[rows[:first]] = True
        ahead = rows[first : first + int(AHEAD * len(rows))]
        seen = (drive[ahead] >= drive[early].min()) & (drive[ahead] <= drive[early].max())
        out.append(Part(early, ahead[seen]))
    return out


def testable(choice: Choice) -> bool:
    """Whether there are rows enough ahead to judge by."""
    return rows_ahead(parts_of(choice.fit.ground)) >= FEWEST_ROWS


def rows_ahead(parts: Sequence[Part]) -> int:
    """How many rows are foretold."""
    return sum(len(part.ahead) for part in parts)


def error_ahead(choice: Choice, parts: Sequence[Part], sure: Sequence[Piece] = ()) -> float:
    """Root mean square error [measurement's unit] on rows after those that it is refitted to.

    A slip that those do not call for is left out, unless it is `sure`: its moment was found by what
    came later.
    """
    ground, square = choice.fit.ground, 0.0
    for part in parts:
        fit = called_for(replace(ground, used=part.early), choice.fit.pieces, sure)
        square += float(np.sum((ground.problem.measured - fit.predicted)[part.ahead] ** 2))
    return max(float(np.sqrt(square / max(rows_ahead(parts), 1))), 1e-300)

"""How much a motion is held back in each direction, and how surely that differs."""

import numpy as np

from pipeline.discrepancy.fitting.fit import Fit, evaluate, improve
from pipeline.discrepancy.model.intervals import DEVIATIONS, FALL, wide_covariance
from pipeline.discrepancy.model.result import Estimate
from pipeline.discrepancy.noise.family import NoiseFamily
from pipeline.discrepancy.search.weighing import Choice
from pipeline.number_words import worded
from pipeline.physics.force_term import ASYMMETRY, ForceTerm
from pipeline.physics.piece import Piece
from pipeline.physics.term import values_of

WAYS = (("rising", 1.0), ("falling", -1.0))


def by_direction(choice: Choice, piece: Piece, family: NoiseFamily) -> tuple[Estimate, ...]:
    """What a term of force resists a rising and a falling position with; () of one without ways.

    Of a term that needs no difference, a form that has one is fitted in its place: its intervals
    tell how large a difference the recording leaves open. Where that fit goes elsewhere, it tells
    nothing about this one; nor does one whose size is none.
    """
    if not (isinstance(piece.term, ForceTerm) and piece.term.directed):
        return ()
    k = choice.fit.pieces.index(piece)
    fit = sided(choice.fit, k)
    around = fit.ground.problem.around
    parameters = fit.pieces[k].term.parameters(around)
    names = [p.name for p in parameters]
    elsewhere = fit is not choice.fit and abs(fit.cost - choice.fit.cost) > FALL
    if ASYMMETRY.name not in names or elsewhere or fit.pieces[k].values[0] == 0.0:
        return ()
    place = names.index(ASYMMETRY.name)
    first = len(fit.nuisance) + sum(len(p.values) for p in fit.pieces[:k])
    at = np.ix_([first, first + place], [first, first + place])
    covariance = wide_covariance(fit, choice.place, family)[at]
    size, asymmetry = fit.pieces[k].values[[0, place]]
    out = []
    for way, sign in WAYS:
        value = float(size * (1.0 + sign * asymmetry))
        slope = np.array([1.0 + sign * asymmetry, sign * size])
        reach = DEVIATIONS * float(np.sqrt(slope @ covariance @ slope))
        own = parameters[0]
        out.append(Estimate(f"{own.name} {way}", value, value - reach, value + reach, own.unit))
    return tuple(out)


def sided(fit: Fit, k: int) -> Fit:
    """The fit with its k-th piece in a form that tells its directions apart, if there is one."""
    piece, around = fit.pieces[k], fit.ground.problem.around
    forms = [t for t in piece.term.richer() if "asymmetric" in t.form]
    if "asymmetric" in piece.term.form or not forms:
        return fit
    names = [p.name for p in piece.term.parameters(around)]
    own = dict(zip(names, (float(v) for v in piece.values), strict=True))
    pieces = list(fit.pieces)
    pieces[k] = Piece(forms[0], values_of(forms[0], around, own))
    return improve(evaluate(fit.ground, pieces))


def said_of_ways(piece: Piece, ways: tuple[Estimate, ...]) -> str:
    """A sentence on two directions that a term does not tell apart; "" where it does."""
    if not ways or "asymmetric" in piece.term.form:
        return ""
    rising, falling = ways
    told = " and ".join(
        f"{worded(e.value)} {e.unit} ({worded(e.low)} to {worded(e.high)}) {way}"
        for e, (way, _) in zip((rising, falling), WAYS, strict=True)
    )
    return f" Told apart by direction it is {told}, which explains nothing more."

"""What a form says beyond its name: modelled, but the catalogue has no name for it."""

from collections.abc import Sequence

import numpy as np
from scipy.special import chdtrc

from pipeline.discrepancy.fitting.fit import Fit, evaluate, improve
from pipeline.discrepancy.judgement.structure import Structure, mismatch_variance
from pipeline.discrepancy.model.result import NamedPhysics
from pipeline.discrepancy.search.explain import Explanation
from pipeline.discrepancy.search.weighing import Choice
from pipeline.physics.catalogue import term
from pipeline.physics.coupling import Coupling
from pipeline.physics.coupling_ways import Lever
from pipeline.physics.piece import Piece

PART = 0.01
PIVOT = 0.05


def alone(fit: Fit, piece: Piece) -> bool:
    """Whether a piece is all of its name, but for what tells where a gain pivots.

    Another axis that changes the gain about an angle other than the simulation's zero (off by the
    offset, and by PIVOT of half the range) seems to move this one besides, by so much at most.
    """
    others = [p for p in fit.pieces if p.term.name == piece.term.name and p is not piece]
    term = piece.term
    if not (isinstance(term, Coupling) and isinstance(term.way, Lever)):
        return not others
    around = fit.ground.problem.around
    half = 0.5 * around.other_span[term.channel]
    pivot = abs(float(fit.nuisance[1])) + 0.5 * PIVOT * around.angle_span
    most = pivot * farthest(piece.values, half)
    return all(
        isinstance(p.term, Coupling)
        and p.term.channel == term.channel
        and p.term.way is None
        and farthest(p.values, half) < most
        for p in others
    )


def farthest(values: np.ndarray, half: float) -> float:
    """How far a slope and a bend, the first of some values, go at the end of half a range."""
    return float(abs(values[0]) * half + abs(values[1]) * half**2)


def beyond_its_name(
    explanation: Explanation, choice: Choice, physics: Sequence[NamedPhysics]
) -> Structure | None:
    """What of the mismatch is in a form that says more than its name; None where none does.

    Its share of the mismatch, and how likely it is by chance (likelihood ratio), against the plain
    form of the same name, refitted beside the rest, or nothing in place of what has no name. What a
    name covers beside others, but not by itself, must be PART of the mismatch.
    """
    fit, others = choice.fit, explanation.problem.motion.others
    tied = {p.name for p in physics if p.alternatives}
    for k, piece in enumerate(fit.pieces):
        says = piece.term.beyond_at(piece.values, explanation.problem.around)
        if alone(fit, piece) and piece.term.name not in tied:
            says = says or piece.term.beyond_alone
        lone = "" if says or len(physics) > 1 else piece.term.beyond_lone
        if not (says or lone):
            continue
        instead: tuple[Piece, ...] = ()
        if not piece.term.nameless:
            plain = term(piece.term.name, piece.term.said_by_name, others)
            free = len(fit.ground.box(plain).parameters)
            instead = (Piece(plain, piece.values[:free]),)
        pieces = (*fit.pieces[:k], *instead, *fit.pieces[k + 1 :])
        other = improve(evaluate(fit.ground, pieces))
        measured, used = explanation.problem.measured, explanation.used
        off = np.mean((measured - other.predicted)[used] ** 2)
        off -= np.mean((measured - fit.predicted)[used] ** 2)
        share = float(np.clip(off / mismatch_variance(explanation), 0.0, 1.0))
        gain = max(other.cost - fit.cost, 0.0)
        p_value = float(chdtrc(fit.free - other.free, gain))
        if says or share > PART:
            return Structure(True, says or lone, share, p_value)
    return None

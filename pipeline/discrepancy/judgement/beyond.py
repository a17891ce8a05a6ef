"""What a form says beyond its name: modelled, but the catalogue has no name for it."""

from collections.abc import Sequence

import numpy as np
from scipy.special import chdtrc

from pipeline.discrepancy.fitting.fit import evaluate, improve
from pipeline.discrepancy.judgement.structure import Structure, mismatch_variance
from pipeline.discrepancy.model.result import NamedPhysics
from pipeline.discrepancy.search.explain import Explanation
from pipeline.discrepancy.search.weighing import Choice
from pipeline.physics.catalogue import term
from pipeline.physics.mechanism import Piece

PART = 0.01


def beyond_its_name(
    explanation: Explanation, choice: Choice, physics: Sequence[NamedPhysics]
) -> Structure | None:
    """What of the mismatch is in a form that says more than its name; None where none does.

    Its share of the mismatch, and how likely it is by chance (likelihood ratio), against the plain
    form of the same name, refitted beside the rest. What a name covers beside others, but not by
    itself, must be PART of the mismatch.
    """
    fit, others = choice.fit, explanation.problem.motion.others
    tied = {p.name for p in physics if p.alternatives}
    for k, piece in enumerate(fit.pieces):
        says = piece.term.beyond
        if fit.names.count(piece.term.name) == 1 and piece.term.name not in tied:
            says = says or piece.term.beyond_alone
        lone = "" if says or len(physics) > 1 else piece.term.beyond_lone
        if not (says or lone):
            continue
        plain = term(piece.term.name, piece.term.said_by_name, others)
        free = len(fit.ground.box(plain).parameters)
        pieces = (*fit.pieces[:k], Piece(plain, piece.values[:free]), *fit.pieces[k + 1 :])
        other = improve(evaluate(fit.ground, pieces))
        measured, used = explanation.problem.measured, explanation.used
        off = np.mean((measured - other.predicted)[used] ** 2)
        off -= np.mean((measured - fit.predicted)[used] ** 2)
        share = float(np.clip(off / mismatch_variance(explanation), 0.0, 1.0))
        gain = max(other.cost - fit.cost, 0.0)
        p_value = float(chdtrc(len(piece.values) - free, gain))
        if says or share > PART:
            return Structure(True, says or lone, share, p_value)
    return None

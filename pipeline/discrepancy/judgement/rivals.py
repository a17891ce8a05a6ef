"""Rivals: the explanations that compete with the chosen one, and how likely each is."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pipeline.discrepancy.fitting.fit import evaluate
from pipeline.discrepancy.model.model import Hypothesis
from pipeline.discrepancy.model.zero import zero_at_end
from pipeline.discrepancy.problem.problem import Problem
from pipeline.discrepancy.search.choose import extended
from pipeline.discrepancy.search.disguise import as_itself, plain
from pipeline.discrepancy.search.equivalents import equivalents
from pipeline.discrepancy.search.explain import Explanation
from pipeline.discrepancy.search.ties import weights_of
from pipeline.discrepancy.search.weighing import RIVAL_GAP, Choice, best_of_each, by_names, names
from pipeline.physics.catalogue import BENDS
from pipeline.physics.mechanism import Mechanism

RIVALS, FORMS = 6, 3


def hypotheses_of(
    problem: Problem, explanation: Explanation, best: Choice
) -> tuple[Hypothesis, ...]:
    """The explanations that compete: the chosen one, and the others by their probability."""
    every = [*explanation.choices, *swapped(explanation, best)]
    near = [c for c in by_names(every) if c.score < best.score + RIVAL_GAP]
    known = {names(c) for c in near}
    distinct = [c for c in near if c is best or as_itself(c, best) or plain(c) not in known]
    if all(c is not best for c in distinct):
        distinct = [best]
    weights = weights_of(distinct)
    found = [
        Hypothesis(
            names=c.fit.names,
            probability=float(w),
            mechanism=mechanism_of(problem, c),
            zero=zero_at_end(problem, c.fit),
            forms=tuple(mechanism_of(problem, o) for o in other_forms(c, every)),
        )
        for c, w in sorted(
            zip(distinct, weights, strict=True), key=lambda x: (x[0] is not best, -x[1])
        )
    ]
    return tuple(found[:RIVALS])


def other_forms(choice: Choice, choices: Sequence[Choice]) -> list[Choice]:
    """The best few choices of the same names in other forms, which fit nearly as well."""
    same = [c for c in best_of_each(choices) if names(c) == names(choice)]
    near = [c for c in same if c.score < choice.score + RIVAL_GAP]
    return [c for c in near if c.fit.key != choice.fit.key][:FORMS]


def swapped(explanation: Explanation, best: Choice) -> list[Choice]:
    """The best choice with a name swapped for one that such commands can't tell from it.

    Only those that the search has left out: it keeps few of those that fit alike.
    """
    search, tried, out = explanation.search, {names(c) for c in explanation.choices}, []
    for name in dict.fromkeys(best.fit.names):
        rest = best.fit.but_for(name)
        rivals = set(equivalents(name, explanation.problem)) - BENDS
        left_out = {r for r in rivals if names(best) - {name} | {r} not in tried}
        if left_out:
            own = replace(search, terms=tuple(t for t in search.terms if t.name in left_out))
            out += extended(own, replace(best, fit=evaluate(best.fit.ground, rest)))
    return out


def mechanism_of(problem: Problem, choice: Choice) -> Mechanism:
    """The choice's mechanism with its calibration."""
    fit = choice.fit
    return Mechanism(
        problem.curve,
        fit.pieces,
        float(fit.nuisance[0]),
        float(fit.nuisance[1]),
        fit.ground.nuisances.error(fit.nuisance),
        problem.course,
    )


def predicted_by(problem: Problem, choice: Choice) -> np.ndarray:
    """What a choice predicts of every row from the start of the recording, (n,)."""
    return mechanism_of(problem, choice).respond(problem.motion)[0]

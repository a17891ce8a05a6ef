"""Names that explain so little of a mismatch that they are the form of the others."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from pipeline.discrepancy.fitting.fit import evaluate, improve
from pipeline.discrepancy.judgement.verdict import mean_square
from pipeline.discrepancy.search.explain import Explanation
from pipeline.discrepancy.search.weighing import Choice, names

LEAST_SHARE, MOST_TOGETHER, MANY = 0.01, 0.02, 3


def names_of_form(explanation: Explanation, best: Choice) -> dict[str, float]:
    """Names of the best choice that are the form of its others, and their shares of the mismatch.

    A real wire is never quite the term: of what that leaves, many samples make names sure that are
    not there. They stay in the corrected simulation, and are not told as physics. Such a name
    explains less than LEAST_SHARE of the mismatch (RMS), calibration apart, and all of them
    together less than MOST_TOGETHER. The one that explains least is taken out first. Of a force
    against motion none is one: beside a weight or a spring, friction is small.
    """
    if explanation.problem.derivatives is not None:
        return {}
    before = mismatch_of(explanation, best)
    begun, told, found = mean_square(explanation, best), best, {}
    while len(names(told)) > 1:
        without = []
        for name in names(told):
            rest = [p for p in told.fit.pieces if p.term.name != name]
            trial = replace(told, fit=improve(evaluate(told.fit.ground, rest)))
            without.append((mean_square(explanation, trial), name, trial))
        left, name, trial = min(without, key=lambda w: w[0])
        own = max(left - mean_square(explanation, told), 0.0)
        if own > LEAST_SHARE**2 * before or left - begun > MOST_TOGETHER**2 * before:
            break
        found[name], told = float(np.sqrt(own / before)), trial
    return found


def one_for_many(explanation: Explanation, best: Choice) -> Choice:
    """The best choice, or one name where that leaves hardly more than MANY names leave together.

    Beyond what they leave it leaves less than LEAST_SHARE of the mismatch (RMS): its form, which
    they mop up, each in a course of its own.
    """
    if explanation.problem.derivatives is not None or len(names(best)) < MANY:
        return best
    most = mean_square(explanation, best) + LEAST_SHARE**2 * mismatch_of(explanation, best)
    ones = [c for c in explanation.choices if len(names(c)) == 1]
    enough = [c for c in ones if mean_square(explanation, c) < most]
    return min(enough, key=lambda c: c.score, default=best)


def mismatch_of(explanation: Explanation, best: Choice) -> float:
    """Mean square of the mismatch that calibration leaves, beyond the noise beside the best."""
    base = next(c for c in explanation.choices if not c.fit.pieces)
    return mean_square(explanation, base) - best.fit.ground.noise.deviation**2


def form_note(formal: Mapping[str, float]) -> list[str]:
    """What the corrected simulation follows besides what is named, and by how much."""
    if not formal:
        return []
    said = " and ".join(f"{name} ({100.0 * share:.1f} %)" for name, share in formal.items())
    return [
        f"The corrected simulation also has {said} of the mismatch: so little is taken for the "
        "form of what is named, not for physics of its own."
    ]

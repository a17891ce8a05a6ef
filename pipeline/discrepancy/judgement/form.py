"""Names that explain so little of a mismatch that they are the form of the others."""

from dataclasses import replace

from pipeline.discrepancy.fitting.fit import evaluate, improve
from pipeline.discrepancy.judgement.verdict import FORM_ERROR, mean_square
from pipeline.discrepancy.search.choose import Choice, names
from pipeline.discrepancy.search.explain import Explanation

LEAST_SHARE = 0.03


def without_form(explanation: Explanation, best: Choice) -> Choice:
    """The best choice without names that explain less than LEAST_SHARE of the mismatch (RMS).

    A real wire is never quite the term: of what that leaves, many samples make names sure that are
    not there. Calibration is no part of the mismatch. The name that explains least goes first, and
    none whose going leaves FORM_ERROR of the mismatch, for that would be no mere form.
    """
    base = next(c for c in explanation.choices if not c.fit.pieces)
    before = mean_square(explanation, base) - best.fit.ground.noise.deviation**2
    begun, told = mean_square(explanation, best), best
    while len(names(told)) > 1:
        without = []
        for name in names(told):
            rest = [p for p in told.fit.pieces if p.term.name != name]
            fit = improve(evaluate(told.fit.ground, rest))
            without.append((mean_square(explanation, replace(told, fit=fit)), fit))
        left, fit = min(without, key=lambda w: w[0])
        explained = left - mean_square(explanation, told)
        if explained > LEAST_SHARE**2 * before or left - begun > FORM_ERROR**2 * before:
            break
        told = explanation.search.weighed(fit, told.place)
    return told

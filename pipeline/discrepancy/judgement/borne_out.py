"""Names that held-out rows bear out, where these are off by more than the rows fitted."""

from dataclasses import replace

import numpy as np

from pipeline.discrepancy.fitting.fit import evaluate, improve
from pipeline.discrepancy.judgement.proof import counted_errors, within
from pipeline.discrepancy.judgement.rivals import mechanism_of
from pipeline.discrepancy.problem.problem import Problem
from pipeline.discrepancy.search.choose import Choice
from pipeline.discrepancy.search.explain import Explanation

NEEDED = 0.1


def borne_out(problem: Problem, explanation: Explanation, choice: Choice) -> Choice:
    """The choice without the names whose absence makes held-out rows hardly worse, refitted.

    A name stays whose absence raises the mean square error there by a tenth. What was learnt from
    the other rows alone and does not hold here mopped up what happened there.
    """
    left = heldout_square(problem, explanation, choice)
    for name in dict.fromkeys(choice.fit.names):
        rest = [p for p in choice.fit.pieces if p.term.name != name]
        fewer = replace(choice, fit=improve(evaluate(choice.fit.ground, rest)))
        if heldout_square(problem, explanation, fewer) < (1.0 + NEEDED) * left:
            return borne_out(problem, explanation, fewer)
    return choice


def heldout_square(problem: Problem, explanation: Explanation, choice: Choice) -> float:
    """Mean square error on the held-out rows that count."""
    predicted = mechanism_of(problem, choice).respond(problem.motion)[0]
    off, counted = counted_errors(problem, explanation, choice, predicted)
    return float(np.mean(off[within(problem, counted)] ** 2))

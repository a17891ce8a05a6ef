"""Names that held-out rows bear out: not one without which they are foretold far better."""

import numpy as np

from pipeline.discrepancy.judgement.proof import within
from pipeline.discrepancy.judgement.rivals import predicted_by
from pipeline.discrepancy.judgement.slipped_again import slipped_again
from pipeline.discrepancy.model.intervals import undated
from pipeline.discrepancy.model.result import root_mean
from pipeline.discrepancy.problem.problem import Problem
from pipeline.discrepancy.search.counted import set_aside
from pipeline.discrepancy.search.explain import Explanation
from pipeline.discrepancy.search.weighing import Choice, names

FAR = 1.5
REFUTED = (
    "Held-out rows refute the {names} that the rows fitted seem to show: they are told far better "
    "without. The held-out error is that of a choice made with them in sight."
)


def borne_out(problem: Problem, explanation: Explanation, best: Choice) -> Choice:
    """The best choice without each name without which it errs FAR less on held-out rows.

    Such a name follows in the training rows what is not there in the others: a slip, say, a zero
    that walks away and comes back. Names of which each needs the others follow it together, and all
    go where calibration alone errs so much less.
    """
    fewer = [likeliest_without(explanation, best, name) for name in sorted(names(best))]
    rows = foretold(problem, explanation, best)
    if not (fewer and rows.any()):
        return best
    fewer += [choice for choice in explanation.choices if not choice.fit.pieces]
    errors = [error_on(problem, choice, rows) for choice in fewer]
    if FAR * min(errors) > error_on(problem, best, rows):
        return best
    return borne_out(problem, explanation, fewer[int(np.argmin(errors))])


def refuted_note(refuted: frozenset[str]) -> list[str]:
    """That names were given up because held-out rows speak against them."""
    return [REFUTED.format(names=" and ".join(sorted(refuted)))] if refuted else []


def foretold(problem: Problem, explanation: Explanation, choice: Choice) -> np.ndarray:
    """Held-out rows (n,), without lone ones, any in which a slip may lie, and those beyond.

    Beyond: at commands beyond the range of those that were fitted.
    """
    predicted = predicted_by(problem, choice)
    counted = ~set_aside(problem, predicted, explanation.prior)
    counted &= ~undated(choice.fit, problem.motion.time_s)
    return within(problem, np.isfinite(problem.measured) & counted)


def error_on(problem: Problem, choice: Choice, rows: np.ndarray) -> float:
    """Error of a choice (RMS) on some rows (n,), foretold from the start of the recording.

    A slip more after the rows fitted speaks against no name.
    """
    predicted = predicted_by(problem, choice)
    again = slipped_again(problem, choice, predicted)
    predicted = predicted if again is None else again.predicted
    return root_mean((problem.measured - predicted)[rows] ** 2)


def likeliest_without(explanation: Explanation, choice: Choice, name: str) -> Choice:
    """The best choice of all names but one, or else what a choice comes to without its pieces."""
    found = [c for c in explanation.choices if names(c) == names(choice) - {name}]
    if found:
        return min(found, key=lambda c: c.score)
    return choice.but_for(name)

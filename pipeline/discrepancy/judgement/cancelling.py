"""Terms of a force that all but cancel each other."""

import numpy as np

from pipeline.discrepancy.fitting.fit import respond
from pipeline.discrepancy.search.weighing import Choice

LARGER = 3.0
CANCELLED = "everywhere: its terms would have to cancel each other"


def cancelling(choice: Choice) -> bool:
    """Whether a term of a force does LARGER times as much as the whole mismatch (deviations).

    Others must take that back, and what two large terms leave of each other follows nearly any
    small curve.
    """
    fit, problem = choice.fit, choice.fit.ground.problem
    if problem.derivatives is None or len(fit.pieces) < 2:
        return False
    used = fit.ground.used
    most = LARGER * float(np.std((problem.measured - problem.simulated)[used]))
    rest = [respond(fit.ground, fit.without(piece)).seen for piece in fit.pieces]
    return any(float(np.std((fit.trace.seen - r)[used])) > most for r in rest)

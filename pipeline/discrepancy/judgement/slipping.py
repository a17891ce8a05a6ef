"""A slip that takes some samples: what is between its levels is no mistake of the sensor."""

import numpy as np

from pipeline.discrepancy.problem.problem import Problem
from pipeline.discrepancy.search.weighing import Choice
from pipeline.physics.lost_steps import LostSteps

LONGEST, BEYOND = 12, 1.2


def slipping(problem: Problem, choice: Choice, off: np.ndarray) -> np.ndarray:
    """Rows (n,) up to LONGEST before or after a slip that are on their way to its other level.

    off: (n,) what the choice leaves. Before the slip some of its jump shows already, after it some
    is still to come.
    """
    rows = np.arange(len(off))
    out = np.zeros(len(off), dtype=bool)
    for piece in choice.fit.pieces:
        if not isinstance(piece.term, LostSteps):
            continue
        for jump, time_s in zip(piece.values[0::2], piece.values[1::2], strict=True):
            first = int(np.searchsorted(problem.motion.time_s, time_s))
            moved = float(jump) * problem.curve.slope
            share = np.where(rows < first, off, -off) / (moved if moved != 0.0 else np.inf)
            near = (rows >= first - LONGEST) & (rows < first + LONGEST)
            out |= near & (share > 0.0) & (share < BEYOND)
    return out

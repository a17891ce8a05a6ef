"""Swinging: samples that stand off to either side by turns, as no mistaken frames do."""

import numpy as np
from scipy.special import bdtrc

from pipeline.discrepancy.search.explain import Explanation
from pipeline.discrepancy.search.weighing import Choice

SOON = 8
FEWEST = 6


def swings(explanation: Explanation, choice: Choice) -> tuple[float, float]:
    """How likely outliers turn so often by chance, and their size (RMS over all training rows).

    A frame that was mistaken says nothing of the next ones. Of two that follow each other within
    SOON samples, but not at once as in a burst, one in two lies on the other side; nor do many
    follow each other so soon. What swings does both. Bonferroni over these two.
    """
    problem = explanation.problem
    rows = np.flatnonzero(problem.train & explanation.outliers)
    off = (problem.measured - choice.fit.predicted)[rows]
    apart = np.diff(rows)
    soon = (apart > 1) & (apart <= SOON)
    turned = int(np.sum(soon & (off[1:] * off[:-1] < 0.0)))
    if turned < FEWEST:
        return 1.0, 0.0
    share = len(rows) / float(problem.train.sum())
    by_chance = 0.5 * (1.0 - (1.0 - share) ** (SOON - 1))
    p_values = (
        float(bdtrc(turned - 1, int(soon.sum()), 0.5)),
        float(bdtrc(turned - 1, len(soon), by_chance)),
    )
    size = float(np.sqrt(np.sum(off**2) / problem.train.sum()))
    return min(1.0, 2.0 * min(p_values)), size

"""Mistaken frames: are the outliers more than noise would give, and how large are they?"""

import numpy as np

from pipeline.discrepancy.explain import Explanation
from pipeline.discrepancy.result import Estimate

FEWEST = 2


def mistaken_frames(explanation: Explanation) -> tuple[Estimate, Estimate] | None:
    """Share and size of the outliers with 95 % intervals, or None where there are too few.

    Judged on training rows. The share's interval is Wilson's, the size's that of a mean.
    """
    problem = explanation.problem
    rows = problem.train & explanation.outliers
    count, n = int(rows.sum()), int(problem.train.sum())
    if count < FEWEST:
        return None
    off = np.abs(problem.measured - explanation.choices[0].fit.predicted)[rows]
    z = 1.96
    middle = (count + 0.5 * z**2) / (n + z**2)
    reach = z / (n + z**2) * np.sqrt(count * (n - count) / n + 0.25 * z**2)
    size = float(np.mean(off))
    error = z * float(np.std(off, ddof=1)) / np.sqrt(count)
    unit = problem.around.angle_unit
    return (
        Estimate("share", count / n, max(middle - reach, 0.0), middle + reach, ""),
        Estimate("size", size, max(size - error, 0.0), size + error, unit),
    )

"""Mistaken frames: are the outliers more than noise would give, and how large are they?"""

import numpy as np

from pipeline.discrepancy.explain import INCREDIBLE, Explanation
from pipeline.discrepancy.intervals import undated
from pipeline.discrepancy.result import Estimate

FEWEST = 3


def mistaken_frames(explanation: Explanation) -> tuple[Estimate, Estimate] | None:
    """Share and size of the outliers with 95 % intervals, or None where there are too few.

    Judged on training rows that the noise does not make credible; neighbours count once, and those
    between which a slip may lie not at all. The share's interval is Wilson's, the size's that of a
    mean.
    """
    problem, fit = explanation.problem, explanation.choices[0].fit
    off = np.abs(problem.measured - fit.predicted)
    rows = problem.train & explanation.outliers & ~undated(fit, problem.motion.time_s)
    rows &= off > INCREDIBLE * fit.ground.noise.deviation
    count, n = int(rows.sum()), int(problem.train.sum())
    if np.sum(np.diff(np.flatnonzero(rows), prepend=-9) > 1) < FEWEST:
        return None
    off = off[rows]
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

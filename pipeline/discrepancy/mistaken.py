"""Mistaken or stale frames: are the outliers more than noise would give, and how large are they?"""

import numpy as np

from pipeline.discrepancy.explain import INCREDIBLE, Explanation
from pipeline.discrepancy.intervals import undated
from pipeline.discrepancy.problem import Problem
from pipeline.discrepancy.result import Estimate
from pipeline.physics.catalogue import term

FEWEST = 3
CREDIBLE, NEARLY_ALL = 3.0, 0.8
STALE = (
    "In {share:.2g} of the frames the camera shows the pose of the frame before: "
    "they are {size:.3g} {unit} off."
)


def mistaken_frames(explanation: Explanation) -> tuple[Estimate, Estimate] | None:
    """Share and size of the outliers with 95 % intervals, or None where there are too few.

    Judged on training rows that the noise does not make credible; neighbours count once, and those
    between which a slip may lie not at all. The share's interval is Wilson's, the size's that of a
    mean.
    """
    problem, fit = explanation.problem, explanation.choices[0].fit
    rows = incredible(explanation)
    count, n = int(rows.sum()), int(problem.train.sum())
    if np.sum(np.diff(np.flatnonzero(rows), prepend=-9) > 1) < FEWEST:
        return None
    off = np.abs(problem.measured - fit.predicted)[rows]
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


def incredible(explanation: Explanation) -> np.ndarray:
    """Training rows (n,) that are off by more than the noise makes credible, but for a slip's."""
    problem, fit = explanation.problem, explanation.choices[0].fit
    rows = problem.train & explanation.outliers & ~undated(fit, problem.motion.time_s)
    off = np.abs(problem.measured - fit.predicted)
    return np.asarray(rows & (off > INCREDIBLE * fit.ground.noise.deviation))


def stale(explanation: Explanation) -> bool:
    """Whether mistaken frames are nearly all what the frame before them should have shown."""
    problem, fit = explanation.problem, explanation.choices[0].fit
    rows = np.flatnonzero(incredible(explanation))
    off = np.abs(problem.measured[rows] - fit.predicted[rows - 1])
    return bool(np.mean(off < CREDIBLE * fit.ground.noise.deviation) > NEARLY_ALL)


def said_of(name: str, found: tuple[Estimate, Estimate], problem: Problem) -> str:
    """One line for a mechanic on mistaken or, as `frame_lag`, stale frames."""
    share, size = (e.value for e in found)
    if name == "frame_lag":
        return STALE.format(share=share, size=size, unit=problem.around.angle_unit)
    return term(name).sentence(np.array([share, size]), problem.around)

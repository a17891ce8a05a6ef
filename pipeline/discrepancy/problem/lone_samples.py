"""Samples of a force that stand alone, before any means over blocks dilute them."""

import numpy as np
from scipy.ndimage import binary_opening

from pipeline.discrepancy.problem.outliers import returning
from pipeline.discrepancy.problem.problem import Problem
from pipeline.discrepancy.problem.repeats import driven_again
from pipeline.discrepancy.problem.spikes import NEIGHBOURS, lone_spikes
from pipeline.discrepancy.problem.travelled import about_reversals, travelled

BY_CHANCE, SWINGING = 1e-3, 3


def lone_samples(problem: Problem) -> np.ndarray:
    """Mask (n,) of known samples that stand apart from those beside them, see `lone_spikes`.

    A few in a row may be friction on a short way back, and what swings from sample to sample is a
    filter's or a joint's answer. Not those that come again where the motion does. Where they go by
    the motion, not those about a reversal: what breaks loose there is no mistake; none where the
    others still do.
    """
    known = problem.train | problem.heldout
    off = np.where(known, problem.measured - problem.simulated, np.nan)
    rows, again = np.flatnonzero(known), driven_again(problem)
    spikes = lone_spikes(off[rows])
    heights = np.zeros(len(off))
    heights[rows] = np.where(spikes.lone, spikes.height, 0.0)
    lone = (heights != 0.0) & ~returning(heights, again)
    lone &= ~binary_opening(lone, np.ones(SWINGING))
    for counted in (known, known & ~about_reversals(problem.motion.drive, NEIGHBOURS)):
        lone &= counted
        if not goes_by_motion(problem, lone, counted):
            return np.asarray(lone)
    return np.zeros(len(off), dtype=bool)


def goes_by_motion(problem: Problem, lone: np.ndarray, counted: np.ndarray) -> bool:
    """Whether samples, a mask (n,), come more than others counted where a motion turns or jerks.

    Sooner after reversals, at lower speeds or at higher accelerations (Kolmogorov-Smirnov).
    """
    if not lone.any():
        return False
    from scipy.stats import ks_2samp  # 0.3 s: only where samples stand alone

    kinetics, others = problem.motion.kinetics, counted & ~lone
    assert kinetics is not None
    travel, speed = travelled(problem.motion.drive), np.abs(kinetics.velocity)
    return any(
        ks_2samp(values[lone], values[others], alternative="greater").pvalue < BY_CHANCE
        for values in (travel, speed, -np.abs(kinetics.acceleration))
    )

"""How much later a force was recorded than the motion that it belongs to."""

from dataclasses import replace

import numpy as np
from scipy.linalg import block_diag

from pipeline.discrepancy.fitting.fit import Fit, evaluate, improve
from pipeline.discrepancy.model.intervals import DEVIATIONS, inverted, precisions
from pipeline.discrepancy.problem.force_problem import averaged
from pipeline.discrepancy.problem.problem import Delay, Problem

MOST = 1.0
PRIOR = 1.0
ROUNDS = 8
STANDING, APART = 0.01, 0.1


def late(problem: Problem, delay: Delay) -> Problem:
    """The problem of a force, not delayed so far, with every row's motion as it was before."""
    return replace(problem, motion=problem.motion.delayed(delay.value), delay=delay)


def delay_of(problem: Problem, fit: Fit) -> Delay:
    """The delay at which a fit of the problem's block means is likeliest, all else refitted.

    A sample of force may stand for the time before it, as behind a filter, or after it, as of a
    drive that holds its command until the next: that is within one sample, which is the deviation
    of a normal prior about none, too. Gauss-Newton in samples; a delay whose 95 % interval holds
    zero is none.
    """
    sample_s = problem.around.dwell_s

    def moved(fit: Fit, samples: float) -> Fit:
        there = averaged(late(problem, Delay(samples * sample_s)), fit.ground.problem.averaged)[0]
        return evaluate(replace(fit.ground, problem=there), fit.pieces)

    samples, variance = 0.0, 0.0
    for _ in range(ROUNDS):
        fit = improve(moved(fit, samples))
        ahead, behind = (moved(fit, samples + way * APART).predicted for way in (1.0, -1.0))
        slope = fit.ground.whiten(((ahead - behind) / (2.0 * APART))[:, None])
        columns = np.hstack([fit.calibrating, fit.slopes, slope])
        variance = float(inverted(columns, block_diag(precisions(fit), PRIOR))[-1, -1])
        step = variance * float(slope[:, 0] @ fit.innovations - PRIOR * samples)
        before, samples = samples, float(np.clip(samples + step, -MOST, MOST))
        if abs(samples - before) < STANDING:
            break
    reach = DEVIATIONS * np.sqrt(variance)
    if abs(samples) <= reach:
        return Delay()
    return Delay(*(sample_s * s for s in (samples, samples - reach, samples + reach)))

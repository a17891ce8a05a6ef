"""Where a zero that walks stood at the end of a recording: from there it walks on."""

from dataclasses import dataclass

import numpy as np

from pipeline.discrepancy.fitting.fit import Fit
from pipeline.discrepancy.problem.problem import Problem
from pipeline.physics.motion import Motion


@dataclass(frozen=True)
class WalkedZero:
    """Level and deviation of the zero at a recording's end [measurement's unit].

    after_s: from the recording's first row to its last one.
    """

    after_s: float
    level: float
    deviation: float

    def later(self, motion: Motion) -> np.ndarray:
        """Which rows (n,) of a motion come after that recording."""
        return np.asarray(motion.time_s - motion.time_s[0] > self.after_s)


def zero_at_end(problem: Problem, fit: Fit) -> WalkedZero | None:
    """The zero that a fit's walk is expected to have reached at the end; None without a walk.

    Learnt from the rows fitted: of a walk w from the first row, E w_n = k' K^-1 r and
    Var w_n = walk^2 n - k' K^-1 k, r being the residual, K the covariance of the noise and
    k_i = walk^2 i that of w_n with row i; the whitening filter is K^-1/2.
    """
    noise = fit.ground.noise
    if noise.walk == 0.0:
        return None
    along = np.where(fit.ground.used, noise.walk**2 * np.arange(len(fit.ground.used)), 0.0)
    white = fit.ground.whiten(along[:, None])[:, 0]
    variance = noise.walk**2 * (len(problem.motion) - 1) - float(white @ white)
    time_s = problem.motion.time_s
    return WalkedZero(
        float(time_s[-1] - time_s[0]), float(white @ fit.innovations), max(variance, 0.0) ** 0.5
    )

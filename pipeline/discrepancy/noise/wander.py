"""Wandering: is what a residual does slowly a walk of the zero, or something that comes back?"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.optimize import minimize

from pipeline.discrepancy.noise.noise import NoiseModel

FINE_ENOUGH = {"maxfev": 250, "xatol": 0.02, "fatol": 0.02}
FAR = 8.0  # logits


def comes_back(
    residual: np.ndarray,
    cycle: np.ndarray,
    used: np.ndarray,
    stands: np.ndarray,
    beside: NoiseModel,
    slowest: float,
) -> tuple[float, NoiseModel]:
    """How much likelier a slow part that comes back makes a residual than one that walks away.

    residual: (n,) of a prediction by commands alone; used: (n,) rows that count; stands: (n,) rows
    in which all commands stand. beside: the noise that was learnt. Twice the difference of the
    greatest log likelihoods of two noises with its jitter of each cycle's zero, which settle where
    it does: white and correlated at any pace, without a walk, and white and correlated up to
    `slowest` from sample to sample, with a walk of any size. With the first of them; where that is
    no slower than `slowest` nothing is gained. A walk has no level: what keeps to one and yet
    forgets more slowly than noise does is no walk.
    """
    filled = np.where(used, residual, 0.0)
    scale = max(float(np.std(filled[used])), 1e-300)

    def likeliest(starts: Sequence[Sequence[float]], most: float) -> tuple[float, NoiseModel]:
        def noise(x: np.ndarray) -> NoiseModel:
            white, correlated = scale * np.exp(np.clip(x[:2], -FAR, FAR))
            correlation = most / (1.0 + np.exp(-np.clip(x[2], -FAR, FAR)))
            walk = scale * float(np.exp(np.clip(x[3], -FAR, FAR))) if len(x) > 3 else 0.0
            return replace(
                beside, white=float(white), correlated=float(correlated),
                correlation=float(correlation), walk=walk,
            )  # fmt: skip

        def cost(x: np.ndarray) -> float:
            return -noise(x).log_likelihood(filled, cycle, used, stands)

        found = min(
            (minimize(cost, start, method="Nelder-Mead", options=FINE_ENOUGH) for start in starts),
            key=lambda f: float(f.fun),
        )
        return -float(found.fun), noise(found.x)

    standing, model = likeliest([(-1.0, -1.0, 0.0), (-1.0, -0.5, 3.5)], 1.0)
    if model.correlation <= slowest:
        return 0.0, model
    walking, _ = likeliest([(-1.0, -1.0, 0.0, -4.0), (-1.0, -1.0, 1.0, -1.5)], slowest)
    return 2.0 * (standing - walking), model

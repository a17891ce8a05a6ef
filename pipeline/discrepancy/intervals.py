"""Intervals: how far each parameter may move before the fit gets worse."""

import numpy as np

from pipeline.discrepancy.fit import Fit, parameters_of
from pipeline.discrepancy.moments import moments, moved
from pipeline.discrepancy.result import Estimate
from pipeline.physics.mechanism import Piece

DEVIATIONS = 2.25  # 1.96, and 15 % for the noise and the form, which are no truth either
FALL = 3.84
WIDEST = 1e12
FARTHEST = 60


def covariance_of(fit: Fit) -> np.ndarray:
    """Covariance of nuisances and then all term parameters, Gauss-Newton under the whitened noise.

    With the priors of both; inflated where the innovations are larger than they should be.
    """
    ground = fit.ground
    j = np.column_stack([fit.calibrating, fit.slopes])
    priors = [ground.precision, *(ground.box(piece.term).precision for piece in fit.pieces)]
    normal = j.T @ j + np.diag(np.concatenate(priors))
    scale = np.sqrt(np.maximum(np.diag(normal), 1.0 / WIDEST))
    inverse = np.linalg.pinv(normal / np.outer(scale, scale), rcond=1e-10, hermitian=True)
    excess = max(float(np.mean(fit.innovations**2)), 1.0)
    return excess * inverse / np.outer(scale, scale)


def estimates(fit: Fit, covariance: np.ndarray) -> list[tuple[Piece, tuple[Estimate, ...]]]:
    """Every term's parameters with 95 % intervals, within their bounds."""
    deviations = np.sqrt(np.maximum(np.diag(covariance), 0.0))[len(fit.nuisance) :]
    out = []
    k = 0
    for i, piece in enumerate(fit.pieces):
        own = []
        for p, value in zip(parameters_of(fit.ground, piece.term), piece.values, strict=True):
            if p.stepwise:
                low, high = moment_interval(fit, i)
            else:
                reach = DEVIATIONS * deviations[k]
                low, high = max(value - reach, p.low), min(value + reach, p.high)
            own.append(Estimate(p.name, float(value), float(low), float(high), p.unit))
            k += 1
        out.append((piece, tuple(own)))
    return out


def moment_interval(fit: Fit, place: int) -> tuple[float, float]:
    """The fitted samples between which the slip lies, as far as the cost tells them apart [s]."""
    time_s = fit.ground.problem.motion.time_s[fit.ground.used]
    times = moments(fit)
    near = int(np.argmin(np.abs(times - fit.pieces[place].values[1])))
    first = last = near
    while first > 0 and near - first < FARTHEST and _as_good(fit, place, times[first - 1]):
        first -= 1
    while (
        last < len(times) - 1 and last - near < FARTHEST and _as_good(fit, place, times[last + 1])
    ):
        last += 1
    return float(time_s[first]), float(time_s[last + 1])


def _as_good(fit: Fit, place: int, moment_s: float) -> bool:
    return moved(fit, place, moment_s).cost < fit.cost + FALL

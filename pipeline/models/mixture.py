"""Gaussian mixture regression: the angle that a command gives, and how sure that is.

A mixture of K two-dimensional Gaussians over (command, angle) is fitted by expectation
maximisation; the regression is its conditional distribution given the command (Ghahramani & Jordan
1994; Cohn et al. 1996). Mean and variance follow the laws of total expectation and total variance.
"""

import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from pipeline.config import TrainingConfig
from pipeline.errors import LoopgapError, refusal

SAMPLES_PER_COMPONENT = 3
CHUNK = 8192
JSON_KEYS = (
    "weights",
    "means_deg",
    "covariances_deg2",
    "range_deg",
    "gain",
    "samples",
    "left_out",
    "converged",
    "log_likelihood",
)


class MixtureError(LoopgapError):
    """A mixture can't be fitted to these samples, or a stored one is no mixture."""


@dataclass(frozen=True)
class MixtureRegression:
    """A fitted mixture over (command, angle) in degrees, and what is known of its samples.

    weights: shape (K,), sum 1. means_deg: shape (K, 2). covariances_deg2: shape (K, 2, 2).
    range_deg: smallest and largest command that it was fitted to. gain: least-squares slope of the
    angle over the command, used beyond that range. left_out: samples without a measured angle.
    log_likelihood: of all samples, densities in 1/deg^2.
    """

    weights: np.ndarray
    means_deg: np.ndarray
    covariances_deg2: np.ndarray
    range_deg: tuple[float, float]
    gain: float
    samples: int
    left_out: int = 0
    converged: bool = True
    log_likelihood: float = 0.0

    @classmethod
    def fit(
        cls,
        command_deg: np.ndarray,
        angle_deg: np.ndarray,
        k: int,
        config: TrainingConfig,
        seed: int,
    ) -> "MixtureRegression":
        """Fit K Gaussians to samples, both of shape (n,); samples that are NaN are left out.

        MixtureError if fewer than three samples a component are left, or if the command stands
        still.
        """
        from sklearn.exceptions import ConvergenceWarning  # half a second: only who fits waits
        from sklearn.mixture import GaussianMixture

        points = np.column_stack([command_deg, angle_deg]).astype(float)
        measured = np.isfinite(points).all(axis=1)
        points, left_out = points[measured], int(np.count_nonzero(~measured))
        _check_samples(points, k, left_out)
        centre, scale = points.mean(axis=0), points.std(axis=0)
        scale[scale == 0.0] = 1.0
        standard = (points - centre) / scale
        mixture = GaussianMixture(
            k,
            n_init=config.n_init,
            reg_covar=config.reg_covar,
            max_iter=config.max_iterations,
            random_state=seed,
        )
        with threadpool_limits(limits=1), warnings.catch_warnings():
            warnings.simplefilter("ignore", ConvergenceWarning)  # kept as `converged`
            mixture.fit(standard)
            log_likelihood = float(mixture.score_samples(standard).sum())
        variance, covariance = np.cov(points.T, bias=True)[0]
        return cls(
            weights=mixture.weights_,
            means_deg=centre + scale * mixture.means_,
            covariances_deg2=mixture.covariances_ * np.outer(scale, scale),
            range_deg=(float(points[:, 0].min()), float(points[:, 0].max())),
            gain=float(covariance / variance),
            samples=len(points),
            left_out=left_out,
            converged=bool(mixture.converged_),
            log_likelihood=log_likelihood - len(points) * float(np.log(scale).sum()),
        )

    @property
    def k(self) -> int:
        """Number of Gaussians."""
        return len(self.weights)

    @property
    def parameters(self) -> int:
        """Free numbers of the mixture: weights, means and symmetric covariances."""
        return 6 * self.k - 1

    def bic(self) -> float:
        """Bayesian information criterion; smaller is better."""
        return float(self.parameters * np.log(self.samples) - 2.0 * self.log_likelihood)

    def aic(self) -> float:
        """Akaike's information criterion; smaller is better."""
        return 2.0 * self.parameters - 2.0 * self.log_likelihood

    def outside(self, command_deg: np.ndarray) -> np.ndarray:
        """Which commands lie beyond those that it was fitted to, shape (n,), bool."""
        low, high = self.range_deg
        return (command_deg < low) | (command_deg > high)

    def predict(self, command_deg: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Mean angle and standard deviation [deg] for commands of shape (n,), both (n,).

        Beyond the range that it was fitted to, the mean goes on from the edge in a straight line
        with the overall gain, and the deviation grows by that whole piece of line (in quadrature).
        """
        command_deg = np.atleast_1d(np.asarray(command_deg, dtype=float))
        inside = np.clip(command_deg, *self.range_deg)
        mean, variance = np.empty_like(inside), np.empty_like(inside)
        for part in _chunks(len(inside)):
            mean[part], variance[part] = self._regress(inside[part])
        beyond = self.gain * (command_deg - inside)
        return mean + beyond, np.sqrt(variance + beyond**2)

    def slope(self, command_deg: np.ndarray) -> np.ndarray:
        """Derivative of the mean by the command, shape (n,); beyond the range it is the gain."""
        command_deg = np.atleast_1d(np.asarray(command_deg, dtype=float))
        slope = np.empty_like(command_deg)
        for part in _chunks(len(command_deg)):
            q = command_deg[part]
            share = self._shares(q)
            gains, line = self._lines(q)
            pull = (self.means_deg[:, :1] - q) / self.covariances_deg2[:, 0, 0, None]
            mean_pull = (share * pull).sum(axis=0)
            slope[part] = gains @ share + (share * (pull - mean_pull) * line).sum(axis=0)
        slope[self.outside(command_deg)] = self.gain
        return slope

    def as_json(self) -> dict[str, Any]:
        """Plain numbers and lists that `from_json` takes back without loss."""
        values = {key: getattr(self, key) for key in JSON_KEYS}
        return {
            key: value.tolist() if isinstance(value, np.ndarray) else value
            for key, value in values.items()
        } | {"range_deg": list(self.range_deg)}

    @classmethod
    def from_json(cls, entry: dict[str, Any]) -> "MixtureRegression":
        """The mixture that `as_json` described; MixtureError names what is missing or misshapen."""
        missing = [key for key in JSON_KEYS if not isinstance(entry, dict) or key not in entry]
        if missing:
            raise MixtureError(
                refusal("mixture", f"{', '.join(JSON_KEYS)}", f"no {missing[0]}", "Train it anew.")
            )
        try:
            weights, means, covariances = (
                np.asarray(entry[key], dtype=float) for key in JSON_KEYS[:3]
            )
            low, high = (float(end) for end in entry["range_deg"])
        except (TypeError, ValueError) as error:
            raise MixtureError(
                refusal("mixture", "lists of numbers", f"{error}", "Train it anew.")
            ) from error
        k = weights.size
        found = (weights.shape, means.shape, covariances.shape)
        if found != ((k,), (k, 2), (k, 2, 2)) or k == 0:
            raise MixtureError(
                refusal("mixture", "shapes (K,), (K, 2), (K, 2, 2)", f"{found}", "Train it anew.")
            )
        rest = {key: entry[key] for key in JSON_KEYS[4:]}
        return cls(weights, means, covariances, (low, high), **rest)

    def _regress(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Conditional mean and total variance: sum h m, sum h (c + (m - mean)^2)."""
        share = self._shares(q)
        gains, line = self._lines(q)
        within = self.covariances_deg2[:, 1, 1] - gains * self.covariances_deg2[:, 0, 1]
        mean = (share * line).sum(axis=0)
        spread = (share * (line - mean) ** 2).sum(axis=0)
        return mean, np.maximum(within, 0.0) @ share + spread

    def _shares(self, q: np.ndarray) -> np.ndarray:
        """Each component's share h of the density at the commands, shape (K, n), by log-sum-exp."""
        variance = self.covariances_deg2[:, 0, 0]
        with np.errstate(divide="ignore"):
            constant = np.log(self.weights) - 0.5 * np.log(variance)
        log_share = constant[:, None] - 0.5 / variance[:, None] * (q - self.means_deg[:, :1]) ** 2
        log_share -= log_share.max(axis=0)
        np.exp(log_share, out=log_share)
        log_share /= log_share.sum(axis=0)
        return log_share

    def _lines(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Each component's gain, shape (K,), and its conditional mean at q, shape (K, n)."""
        gains = self.covariances_deg2[:, 0, 1] / self.covariances_deg2[:, 0, 0]
        offsets = self.means_deg[:, 1] - gains * self.means_deg[:, 0]
        return gains, gains[:, None] * q + offsets[:, None]


def largest_k(samples: int) -> int:
    """How many Gaussians so many samples allow."""
    return samples // SAMPLES_PER_COMPONENT


def _chunks(n: int) -> Iterator[slice]:
    """Slices that keep K x n intermediate arrays in the processor's cache."""
    return (slice(start, start + CHUNK) for start in range(0, n, CHUNK))


def _check_samples(points: np.ndarray, k: int, left_out: int) -> None:
    if k < 1:
        raise MixtureError(
            refusal("mixture", "at least one Gaussian", f"K = {k}", "Set selection.k to 1 or more.")
        )
    if k > largest_k(len(points)):
        raise MixtureError(
            refusal(
                "mixture",
                f"at least {SAMPLES_PER_COMPONENT * k} measured samples for K = {k}",
                f"{len(points)} ({left_out} more have no measured angle)",
                f"Record more, or choose K of at most {largest_k(len(points))}.",
            )
        )
    if np.ptp(points[:, 0]) == 0.0:
        raise MixtureError(
            refusal(
                "mixture",
                "a command that moves",
                f"{points[0, 0]:g} deg in all {len(points)} samples",
                "Drive the axis, or leave it out of the work.",
            )
        )

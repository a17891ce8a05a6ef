"""A zero that wanders smoothly, as temperature moves it, beside noise that forgets at once.

It is a Gaussian process with the Matern covariance of smoothness 3/2 (Rasmussen and Williams,
Gaussian Processes for Machine Learning, section 4.2), followed from row to row by a Kalman filter
(Hartikainen and Sarkka, IEEE MLSP (2010) 379).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numba import njit
from scipy.optimize import minimize

from pipeline.discrepancy.noise.noise import SLOW_CORRELATION

FINE_ENOUGH = {"maxfev": 400, "xatol": 0.01, "fatol": 0.01}
PACES = (0.05, 0.2)
SLOWEST, FASTEST = 1e-3, 3.0


@dataclass(frozen=True)
class SmoothZero:
    """A smooth zero and the noise beside it [measurement's unit].

    white, fast: standard deviations of what is independent in each sample, and of a first-order
    autoregression with `correlation` from sample to sample. zero: standard deviation of the zero.
    pace: of its covariance zero^2 (1 + pace k) exp(-pace k) over k rows [1/row].
    """

    white: float
    fast: float
    correlation: float
    zero: float
    pace: float

    @property
    def deviation(self) -> float:
        """Standard deviation of a sample about the zero."""
        return float(np.hypot(self.white, self.fast))

    def innovations(
        self, columns: np.ndarray, carrier: np.ndarray, used: np.ndarray
    ) -> tuple[np.ndarray, float]:
        """Columns (n, m) as independent unit innovations (used rows, m), and their log scales' sum.

        carrier: (n,) what the zero is multiplied with in each row.
        """
        sizes = self.white, self.fast, self.correlation, self.zero, self.pace
        return followed_smoothly(np.ascontiguousarray(columns), carrier, used, sizes)

    def log_likelihood(self, residual: np.ndarray, carrier: np.ndarray, used: np.ndarray) -> float:
        """Log density of a residual (n,) on the used rows (n,), up to a constant."""
        e, log_scale = self.innovations(residual[:, None], carrier, used)
        return float(-0.5 * np.sum(e**2) - log_scale)


def likeliest_zero(
    residual: np.ndarray,
    carrier: np.ndarray,
    used: np.ndarray,
    begun: Sequence[SmoothZero] = (),
) -> tuple[float, SmoothZero]:
    """The likeliest smooth zero of a residual (n,) on used rows (n,), and its log likelihood.

    carrier: (n,), see `SmoothZero.innovations`. begun: where to begin, if not at the usual paces.
    """
    filled = np.where(used, residual, 0.0)
    scale = max(float(np.std(filled[used])), 1e-300)
    steps = np.diff(filled[used])
    rough = max(float(np.median(np.abs(steps))), 1e-3 * scale)

    def model(x: np.ndarray) -> SmoothZero:
        white, fast, zero = scale * np.exp(np.clip(x[:3], -20.0, 5.0))
        pace = float(np.clip(np.exp(np.clip(x[4], -20.0, 5.0)), SLOWEST, FASTEST))
        correlation = SLOW_CORRELATION / (1.0 + np.exp(-np.clip(x[3], -20.0, 20.0)))
        return SmoothZero(float(white), float(fast), float(correlation), float(zero), pace)

    def cost(x: np.ndarray) -> float:
        return -model(x).log_likelihood(filled, carrier, used)

    usual = [SmoothZero(rough, 0.4 * rough, 0.5 * SLOW_CORRELATION, scale, p) for p in PACES]
    starts = [
        [
            *np.log(np.maximum([z.white, z.fast, z.zero], 1e-8 * scale) / scale),
            np.log(z.correlation / max(SLOW_CORRELATION - z.correlation, 1e-6)),
            np.log(z.pace),
        ]
        for z in (begun or usual)
    ]
    found = min(
        (minimize(cost, start, method="Nelder-Mead", options=FINE_ENOUGH) for start in starts),
        key=lambda f: float(f.fun),
    )
    return -float(found.fun), model(found.x)


@njit(cache=True, error_model="numpy")
def followed_smoothly(columns, carrier, used, sizes):  # type: ignore[no-untyped-def]
    """Innovations over their deviations (used rows, m), and the sum of these' logs.

    sizes: as the fields of `SmoothZero`. The state is the fast noise, the zero and its slope.
    """
    white, _, kept, _, pace = sizes
    far = np.exp(-pace)
    steps = kept, far * (1.0 + pace), far, -pace * pace * far, far * (1.0 - pace)
    _, a, b, c, d = steps
    m = columns.shape[1]
    out = np.empty((np.count_nonzero(used), m))
    quick, zero, slope = np.zeros(m), np.zeros(m), np.zeros(m)
    spread, fresh = _begun(sizes, steps)
    row, logs = 0, 0.0
    for i in range(carrier.size):
        if i > 0:
            spread = _later(spread, steps, fresh)
            for k in range(m):
                quick[k] *= kept
                zero[k], slope[k] = a * zero[k] + b * slope[k], c * zero[k] + d * slope[k]
        if not used[i]:
            continue
        gains, variance, spread = _seen(spread, carrier[i], white * white)
        deviation = np.sqrt(variance)
        for k in range(m):
            off = columns[i, k] - quick[k] - carrier[i] * zero[k]
            quick[k] += gains[0] * off
            zero[k] += gains[1] * off
            slope[k] += gains[2] * off
            out[row, k] = off / deviation
        logs += np.log(deviation)
        row += 1
    return out, logs


@njit(cache=True, error_model="numpy")
def _begun(sizes, steps):  # type: ignore[no-untyped-def]
    """Covariance of the state at first, its six elements row by row, and what each row adds."""
    _, fast, kept, zero, pace = sizes
    _, a, b, c, d = steps
    f, z, s = fast * fast, zero * zero, (pace * zero) ** 2
    fresh = (
        f * (1.0 - kept * kept), 0.0, 0.0,
        z - a * a * z - b * b * s, -a * c * z - b * d * s, s - c * c * z - d * d * s,
    )  # fmt: skip
    return (f, 0.0, 0.0, z, 0.0, s), fresh


@njit(cache=True, error_model="numpy")
def _later(spread, steps, fresh):  # type: ignore[no-untyped-def]
    """Covariance of the state a row later."""
    f, fz, fs, z, zs, s = spread
    kept, a, b, c, d = steps
    return (
        kept * kept * f + fresh[0],
        kept * (a * fz + b * fs),
        kept * (c * fz + d * fs),
        a * a * z + 2.0 * a * b * zs + b * b * s + fresh[3],
        a * c * z + (a * d + b * c) * zs + b * d * s + fresh[4],
        c * c * z + 2.0 * c * d * zs + d * d * s + fresh[5],
    )


@njit(cache=True, error_model="numpy")
def _seen(spread, carrier, white):  # type: ignore[no-untyped-def]
    """Kalman gains of a row, the innovation's variance, and the covariance of the state then."""
    f, fz, fs, z, zs, s = spread
    u, v, w = f + carrier * fz, fz + carrier * z, fs + carrier * zs
    variance = u + carrier * v + white
    one = 1.0 / variance
    left = (
        f - u * u * one, fz - u * v * one, fs - u * w * one,
        z - v * v * one, zs - v * w * one, s - w * w * one,
    )  # fmt: skip
    return (u * one, v * one, w * one), variance, left

"""Errors that depend on the errors before them: fitted by restricted likelihood, then whitened."""

from dataclasses import dataclass

import numpy as np
from numba import njit
from scipy.linalg import eigh
from scipy.optimize import minimize

TOLERANCE = 1e-8
LARGEST_LOGIT = 7.0


@dataclass(frozen=True)
class SerialNoise:
    """Noise with variance sigma^2, of which `share` is AR(1) and the rest white.

    correlation: of the AR(1) part from one row of the recording to the next, 0 to 1.
    """

    sigma: float
    correlation: float
    share: float

    @property
    def spell(self) -> float:
        """How many neighbouring rows say the same on average: the sum of all autocorrelations."""
        return 1.0 + 2.0 * self.share * self.correlation / (1.0 - self.correlation)

    def whiten(self, columns: np.ndarray, row: np.ndarray) -> np.ndarray:
        """Columns, shape (m, p), as innovations of unit variance where they were noise of sigma 1.

        row: (m,) rising row numbers in the recording; rows between that are missing are bridged.
        """
        gap = np.diff(row, prepend=row[:1])
        return _innovations(np.ascontiguousarray(columns), gap, self.correlation, self.share)[0]

    def excess(self, columns: np.ndarray, row: np.ndarray) -> float:
        """Expected squared length of unit noise projected on orthonormal columns, shape (m, k).

        It is k for white noise, more where smooth columns meet correlated noise.
        """
        if self.share * self.correlation < 1e-6:
            return float(np.sum(columns**2))
        full = np.zeros((int(row[-1] - row[0]) + 1, columns.shape[1]))
        full[row - row[0]] = columns
        lagged = _running(full, self.correlation)
        ar = 2.0 * float(np.sum(full * lagged)) - float(np.sum(full**2))
        return self.share * ar + (1.0 - self.share) * float(np.sum(full**2))


@njit(cache=True)
def _innovations(
    columns: np.ndarray, gap: np.ndarray, correlation: float, share: float
) -> tuple[np.ndarray, float]:
    rows, width = columns.shape
    out = np.empty((rows, width))
    state = np.zeros(width)
    spread = share
    log_det = 0.0
    for i in range(rows):
        kept = correlation ** gap[i] if i > 0 else 1.0
        spread = kept * kept * spread + share * (1.0 - kept * kept)
        variance = spread + 1.0 - share
        gain = spread / variance
        scale = 1.0 / np.sqrt(variance)
        for j in range(width):
            state[j] *= kept
            surprise = columns[i, j] - state[j]
            out[i, j] = surprise * scale
            state[j] += gain * surprise
        spread *= 1.0 - gain
        log_det += np.log(variance)
    return out, log_det


@njit(cache=True)
def _running(columns: np.ndarray, correlation: float) -> np.ndarray:
    out = columns.copy()
    for i in range(1, columns.shape[0]):
        for j in range(columns.shape[1]):
            out[i, j] += correlation * out[i - 1, j]
    return out


def orthonormal(columns: np.ndarray, length: np.ndarray | None = None) -> np.ndarray:
    """An orthonormal basis, shape (m, k), of what the columns, shape (m, p), span; k <= p.

    length: (p,) of each column before something was taken out of it (its own by default); what is
    left of one counts only above 1e-4 of that length.
    """
    if length is None:
        length = lengths(columns)
    kept = columns[:, length > 0.0] / length[length > 0.0]
    values, vectors = eigh(kept.T @ kept, driver="ev")  # divide and conquer fails on some
    strong = values > TOLERANCE
    return kept @ (vectors[:, strong] / np.sqrt(values[strong]))


def lengths(columns: np.ndarray) -> np.ndarray:
    """Euclidean length of each column of (m, p), shape (p,)."""
    return np.sqrt(np.einsum("ij,ij->j", columns, columns))


def without(columns: np.ndarray, basis: np.ndarray) -> np.ndarray:
    """What is left of columns, (m, p) or (m,), beside an orthonormal basis (m, k)."""
    return columns - basis @ (basis.T @ columns)


def fit_serial_noise(values: np.ndarray, row: np.ndarray, explained: np.ndarray) -> SerialNoise:
    """Sigma, correlation and share of the noise in values, shape (m,), around a linear model.

    explained: (m, p) columns of that model; their freedom is accounted for by the restricted
    likelihood (Patterson and Thompson, Biometrika 58, 1971), so that a large model does not make
    the noise look smaller or less correlated than it is. row: (m,) row numbers of the recording.
    """
    model = orthonormal(explained)
    freedom = len(values) - model.shape[1]
    if freedom < 8:
        return SerialNoise(float(np.std(values)), 0.0, 0.0)
    stacked = np.ascontiguousarray(np.column_stack([model, without(values, model)]))
    gap = np.diff(row, prepend=row[:1])

    def misfit(point: np.ndarray) -> float:
        correlation, share = _squash(point)
        white, log_det = _innovations(stacked, gap, correlation, share)
        gram = white.T @ white
        inner, cross = gram[:-1, :-1], gram[:-1, -1]
        sign, log_inner = np.linalg.slogdet(inner)
        if sign <= 0:
            return 1e12
        left = gram[-1, -1] - cross @ np.linalg.solve(inner, cross)
        return float(log_det + log_inner + freedom * np.log(max(left, 1e-300)))

    start = np.array([0.0, 0.0])
    found = minimize(
        misfit,
        start,
        method="Nelder-Mead",
        options={"xatol": 0.05, "fatol": 0.05, "maxfev": 60,
                 "initial_simplex": np.array([[0.0, 0.0], [1.5, 0.0], [0.0, -1.5]])},
    )  # fmt: skip
    correlation, share = _squash(found.x)
    shape = SerialNoise(1.0, correlation, share)
    white = shape.whiten(stacked, row)
    left = without(white[:, -1], orthonormal(white[:, :-1]))
    return SerialNoise(float(np.sqrt(left @ left / freedom)), correlation, share)


def _squash(point: np.ndarray) -> tuple[float, float]:
    bounded = 1.0 / (1.0 + np.exp(-np.clip(point, -LARGEST_LOGIT, LARGEST_LOGIT)))
    return float(bounded[0]), float(bounded[1])

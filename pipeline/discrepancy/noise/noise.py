"""The noise (white, correlated, jitter of each cycle's zero, slow walk) and its whitening."""

from dataclasses import dataclass

import numpy as np
from numba import njit


@njit(cache=True)
def gains_of(white, correlated, kept, jitter, walk, cycle, used):  # type: ignore[no-untyped-def]
    """Kalman gains for the state (correlated, jitter, walk), one row each sample.

    kept: (n,) correlation with the sample before. Returns (n, 4): the three gains and the
    innovation's standard deviation (0 where not used).
    """
    n = kept.size
    out = np.zeros((n, 4))
    p = np.zeros((3, 3))
    p[0, 0] = correlated * correlated
    p[1, 1] = jitter * jitter
    for i in range(n):
        if i > 0:
            for j in range(3):
                p[0, j] *= kept[i]
                p[j, 0] *= kept[i]
            p[0, 0] += correlated * correlated * (1.0 - kept[i] * kept[i])
            p[2, 2] += walk * walk
            if cycle[i] != cycle[i - 1]:
                for j in range(3):
                    p[1, j] = 0.0
                    p[j, 1] = 0.0
                p[1, 1] = jitter * jitter
        if not used[i]:
            continue
        h0 = p[0, 0] + p[0, 1] + p[0, 2]
        h1 = p[1, 0] + p[1, 1] + p[1, 2]
        h2 = p[2, 0] + p[2, 1] + p[2, 2]
        s = h0 + h1 + h2 + white * white
        out[i, 0], out[i, 1], out[i, 2], out[i, 3] = h0 / s, h1 / s, h2 / s, np.sqrt(s)
        h = (h0, h1, h2)
        for j in range(3):
            for k in range(3):
                p[j, k] -= h[j] * h[k] / s
    return out


@njit(cache=True)
def whitened(columns, gains, kept, cycle):  # type: ignore[no-untyped-def]
    """Innovations over their deviations, (used rows, m); kept: as for the gains."""
    n, m = columns.shape
    out = np.empty((np.count_nonzero(gains[:, 3]), m))
    a, b, c = np.zeros(m), np.zeros(m), np.zeros(m)
    so_far, row = 1.0, 0
    for i in range(n):
        if i > 0:
            so_far *= kept[i]
            if cycle[i] != cycle[i - 1]:
                b[:] = 0.0
        if gains[i, 3] == 0.0:
            continue
        g0, g1, g2, weight = gains[i, 0], gains[i, 1], gains[i, 2], 1.0 / gains[i, 3]
        for k in range(m):
            late = so_far * a[k]
            e = columns[i, k] - late - b[k] - c[k]
            a[k] = late + g0 * e
            b[k] += g1 * e
            c[k] += g2 * e
            out[row, k] = e * weight
        so_far, row = 1.0, row + 1
    return out


@dataclass(frozen=True)
class NoiseModel:
    """Gaussian noise [measurement's unit]: the sum of four parts.

    white: standard deviation of what is independent in each sample. correlated: of a first-order
    autoregression with `correlation` from sample to sample. jitter: of a constant that is drawn
    anew in each cycle. walk: of a random walk's step from one sample to the next. spell: how many
    samples in a row say the same, so that each counts as one over so many. settles: whether the
    correlated part is drawn anew only where something is commanded to move, and stands where all
    commands stand: where a joint comes to rest is then part of the noise.
    """

    white: float
    correlated: float = 0.0
    correlation: float = 0.0
    jitter: float = 0.0
    walk: float = 0.0
    spell: float = 1.0
    settles: bool = False

    @property
    def deviation(self) -> float:
        """Standard deviation of one sample about its cycle's own zero."""
        return float(np.hypot(self.white, self.correlated))

    def kept(self, stands: np.ndarray) -> np.ndarray:
        """Correlation of each sample (n,) with the one before, given where all commands stand."""
        return np.where(stands & self.settles, 1.0, self.correlation)

    def gains(self, cycle: np.ndarray, used: np.ndarray, stands: np.ndarray) -> np.ndarray:
        """The whitening filter of these rows, (n, 4); the same for every signal.

        stands: (n,) rows in which all commands are what they were in the row before.
        """
        gains: np.ndarray = gains_of(
            self.white,
            self.correlated,
            self.kept(stands),
            self.jitter,
            self.walk,
            np.ascontiguousarray(cycle, dtype=np.int64),
            np.ascontiguousarray(used),
        )
        gains[:, 3] *= np.sqrt(self.spell)
        return gains

    def whiten(
        self, columns: np.ndarray, cycle: np.ndarray, used: np.ndarray, stands: np.ndarray
    ) -> np.ndarray:
        """Columns (n, m) as independent unit innovations of the used rows, (used rows, m).

        Missing rows are treated exactly (the filter predicts over them).
        """
        filled = np.where(used[:, None], columns, 0.0)
        gains = self.gains(cycle, used, stands)
        return whitened(
            np.ascontiguousarray(filled),
            gains,
            self.kept(stands),
            np.ascontiguousarray(cycle, dtype=np.int64),
        )

    def log_likelihood(
        self, residual: np.ndarray, cycle: np.ndarray, used: np.ndarray, stands: np.ndarray
    ) -> float:
        """Log density of residual (n,) on the used rows."""
        gains = self.gains(cycle, used, stands)
        filled = np.where(used, residual, 0.0)[:, None]
        e = whitened(filled, gains, self.kept(stands), np.asarray(cycle, dtype=np.int64))
        s = gains[used, 3]
        return float(-0.5 * np.sum(e**2) - np.sum(np.log(s)) - 0.5 * s.size * np.log(2 * np.pi))

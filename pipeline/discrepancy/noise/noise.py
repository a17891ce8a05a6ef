"""The noise (white, correlated, jitter of each cycle's zero, slow walk) and its whitening."""

from dataclasses import dataclass

import numpy as np
from numba import njit

SLOW_CORRELATION = 0.87  # from sample to sample; what is slower is as slow as physics


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def _gone_on(spread, kept, squares, anew):  # type: ignore[no-untyped-def]
    """Covariance of the state a sample later; squares: white, correlated, jitter, walk, each ^2.

    spread: its six different elements, row by row. anew: whether a cycle begins.
    """
    a, ab, ac, b, bc, c = spread
    a = kept * kept * a + squares[1] * (1.0 - kept * kept)
    ab, ac, c = kept * ab, kept * ac, c + squares[3]
    return (a, 0.0, ac, squares[2], 0.0, c) if anew else (a, ab, ac, b, bc, c)


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def _known(spread, white):  # type: ignore[no-untyped-def]
    """Kalman gains of a sample, the innovation's variance, and the covariance of the state then."""
    a, ab, ac, b, bc, c = spread
    f, g, h = a + ab + ac, ab + b + bc, ac + bc + c
    variance = f + g + h + white
    one = 1.0 / variance
    u, v, w = f * one, g * one, h * one
    left = a - u * f, ab - u * g, ac - u * h, b - v * g, bc - v * h, c - w * h
    return (u, v, w), variance, left


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def gains_of(white, correlated, kept, jitter, walk, cycle, used):  # type: ignore[no-untyped-def]
    """Kalman gains for the state (correlated, jitter, walk), one row each sample.

    kept: (n,) correlation with the sample before. Returns (n, 4): the three gains and the
    innovation's standard deviation (0 where not used).
    """
    out = np.zeros((kept.size, 4))
    squares = white * white, correlated * correlated, jitter * jitter, walk * walk
    spread = squares[1], 0.0, 0.0, squares[2], 0.0, 0.0
    for i in range(kept.size):
        if i > 0:
            spread = _gone_on(spread, kept[i], squares, cycle[i] != cycle[i - 1])
        if used[i]:
            gains, variance, spread = _known(spread, squares[0])
            out[i, 0], out[i, 1], out[i, 2] = gains
            out[i, 3] = np.sqrt(variance)
    return out


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def likelihood_of(residual, white, correlated, kept, jitter, walk, cycle, used):  # type: ignore[no-untyped-def]
    """Sums over the used rows of squared innovations over their variances, and of these' logs."""
    squares = white * white, correlated * correlated, jitter * jitter, walk * walk
    spread = squares[1], 0.0, 0.0, squares[2], 0.0, 0.0
    slow, zero, gone, total, logs, product = 0.0, 0.0, 0.0, 0.0, 0.0, 1.0
    for i in range(kept.size):
        if i > 0:
            anew = cycle[i] != cycle[i - 1]
            spread = _gone_on(spread, kept[i], squares, anew)
            slow, zero = kept[i] * slow, 0.0 if anew else zero
        if used[i]:
            gains, variance, spread = _known(spread, squares[0])
            off = residual[i] - slow - zero - gone
            slow, zero, gone = slow + gains[0] * off, zero + gains[1] * off, gone + gains[2] * off
            total += off * off / variance
            product *= variance
            if not 1e-100 < product < 1e100:
                logs, product = logs + np.log(product), 1.0
    return total, logs + np.log(product)


@njit(cache=True, fastmath={"contract", "reassoc", "nsz"}, error_model="numpy")
def whitened(columns, gains, kept, cycle):  # type: ignore[no-untyped-def]
    """Innovations over their deviations, (used rows, m); kept: as for the gains."""
    n, m = columns.shape
    out = np.empty((np.count_nonzero(gains[:, 3]), m))
    if 1 <= m <= 2:
        _whitened_pair(columns, gains, kept, cycle, out)
        return out
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


@njit(cache=True, fastmath={"contract", "reassoc", "nsz"}, error_model="numpy")
def _whitened_pair(columns, gains, kept, cycle, out):  # type: ignore[no-untyped-def]
    """The same (into `out`) for one column or two: three times as fast with no array in between."""
    other = columns.shape[1] - 1
    a, b, c, aa, bb, cc = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    so_far, row = 1.0, 0
    for i in range(columns.shape[0]):
        if i > 0:
            so_far *= kept[i]
            if cycle[i] != cycle[i - 1]:
                b, bb = 0.0, 0.0
        if gains[i, 3] == 0.0:
            continue
        g0, g1, g2, weight = gains[i, 0], gains[i, 1], gains[i, 2], 1.0 / gains[i, 3]
        late, later = so_far * a, so_far * aa
        e, ee = columns[i, 0] - (late + b + c), columns[i, other] - (later + bb + cc)
        a, b, c = late + g0 * e, b + g1 * e, c + g2 * e
        aa, bb, cc = later + g0 * ee, bb + g1 * ee, cc + g2 * ee
        out[row, 0], out[row, other] = e * weight, ee * weight
        so_far, row = 1.0, row + 1


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def square_of(residual, gains, kept, cycle, level):  # type: ignore[no-untyped-def]
    """Squared length of a residual (n,) whitened, and its part along `level` (used rows,)."""
    slow, zero, gone, square, along, row = 0.0, 0.0, 0.0, 0.0, 0.0, 0
    for i in range(residual.size):
        if i > 0:
            slow *= kept[i]
            if cycle[i] != cycle[i - 1]:
                zero = 0.0
        if gains[i, 3] > 0.0:
            off = residual[i] - (zero + gone) - slow
            slow, zero, gone = (
                slow + gains[i, 0] * off, zero + gains[i, 1] * off, gone + gains[i, 2] * off
            )  # fmt: skip
            white = off / gains[i, 3]
            square += white * white
            along += white * level[row]
            row += 1
    return square, along


@njit(cache=True)
def _kept_on(fresh, kept):  # type: ignore[no-untyped-def]
    """What comes anew in each row (n,) and what is kept of the rows before."""
    out = fresh.copy()
    for i in range(1, out.size):
        out[i] += kept[i] * out[i - 1]
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

    @property
    def alike(self) -> float:
        """How many samples say as much of its size as one on its own would.

        1 + 2 times the sum of squared autocorrelations (Bartlett, J. R. Stat. Soc. B 8 (1946) 27).
        """
        share = self.correlated**2 / max(self.deviation**2, 1e-300)
        again = self.correlation**2
        return self.spell * float(1.0 + 2.0 * share**2 * again / (1.0 - again))

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

    def drawn(self, cycle: np.ndarray, stands: np.ndarray, rng: np.random.Generator) -> np.ndarray:
        """A draw of it in rows of these cycles, (n,), each sample counted by itself."""
        n, kept = len(cycle), self.kept(stands)
        fresh = self.correlated * rng.standard_normal(n)
        fresh[1:] *= np.sqrt(1.0 - kept[1:] ** 2)
        slow = _kept_on(fresh, kept)
        zeros = self.jitter * rng.standard_normal(n)[np.unique(cycle, return_inverse=True)[1]]
        walked = np.cumsum(self.walk * rng.standard_normal(n))
        return np.asarray(self.white * rng.standard_normal(n) + slow + zeros + walked)

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
        squares, logs = likelihood_of(
            residual, self.white, self.correlated, self.kept(stands), self.jitter, self.walk,
            np.asarray(cycle, dtype=np.int64), used,
        )  # fmt: skip
        count = np.count_nonzero(used)
        logs += count * np.log(2.0 * np.pi * self.spell)
        return float(-0.5 * (squares / self.spell + logs))

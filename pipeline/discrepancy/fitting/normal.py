"""Normal equations of a few unknowns, compiled: fits solve very many of them."""

import numpy as np
from numba import njit

from pipeline.discrepancy.noise.noise import whitened

SMALLEST_PIVOT = 1e-15  # over the diagonal: what is less is rounding
NOTHING = 1e-12  # squared deviations over all of a parameter's range


@njit(cache=True, error_model="numpy")
def solved(normal, right):  # type: ignore[no-untyped-def]
    """x (p, m) with normal x = right, of a positive definite normal (p, p), by Cholesky."""
    size, many = right.shape
    root, x = np.empty((size, size)), np.empty((size, many))
    for i in range(size):
        for j in range(i + 1):
            left = normal[i, j]
            for k in range(j):
                left -= root[i, k] * root[j, k]
            least = SMALLEST_PIVOT * normal[i, i]
            root[i, j] = np.sqrt(max(left, least)) if i == j else left / root[j, j]
    for m in range(many):
        for i in range(size):
            left = right[i, m]
            for k in range(i):
                left -= root[i, k] * x[k, m]
            x[i, m] = left / root[i, i]
        for i in range(size - 1, -1, -1):
            for k in range(i + 1, size):
                x[i, m] -= root[k, i] * x[k, m]
            x[i, m] /= root[i, i]
    return x


@njit(cache=True, error_model="numpy")
def regressed(columns, data, kalman, precision, expected):  # type: ignore[no-untyped-def]
    """Weights (m,) of columns (n, m) that suit whitened data (count,) and a Gaussian prior best.

    kalman: the arguments of the whitening, see `whitened`. precision, expected: (m, m), (m,) of the
    prior. Besides: the innovations (count,), the columns whitened, (count, m), and -2 log of
    likelihood and prior without constants.
    """
    white = whitened(columns, kalman[0], kalman[1], kalman[2])
    size = expected.size
    normal, right = precision.copy(), np.zeros((size, 1))
    for j in range(size):
        for k in range(size):
            right[j, 0] += precision[j, k] * expected[k]
        for k in range(j + 1):
            normal[j, k] += _product(white[:, j], white[:, k])
        right[j, 0] += _product(white[:, j], data)
    weights, innovations = solved(normal, right)[:, 0].copy(), data.copy()
    for i in range(data.size):
        for j in range(size):
            innovations[i] -= white[i, j] * weights[j]
    cost = _product(innovations, innovations)
    for j in range(size):
        for k in range(size):
            cost += (weights[j] - expected[j]) * precision[j, k] * (weights[k] - expected[k])
    return weights, innovations, white, cost


@njit(cache=True, fastmath=True)
def _product(a, b):  # type: ignore[no-untyped-def]
    total = 0.0
    for i in range(a.size):
        total += a[i] * b[i]
    return total


@njit(cache=True, error_model="numpy")
def stepped(values, normal, gradient, low, high, damping):  # type: ignore[no-untyped-def]
    """Values (p,) one damped step on, within bounds, and the fall of the cost which that foretells.

    gradient: of half the fall. A value at a bound that it drives against, or that moves nothing,
    stays.
    """
    moved = values.copy()
    upward = (gradient > 0.0) & (values < high) | (gradient < 0.0) & (values > low)
    moves = np.diag(normal) * (high - low) ** 2 > NOTHING
    free = np.flatnonzero((upward | (gradient == 0.0)) & moves)
    own, right = np.empty((free.size, free.size)), np.empty((free.size, 1))
    for i, k in enumerate(free):
        right[i, 0] = gradient[k]
        for j, other in enumerate(free):
            own[i, j] = normal[k, other]
        own[i, i] *= 1.0 + damping
    step = solved(own, right)
    for i, k in enumerate(free):
        moved[k] = min(max(values[k] + step[i, 0], low[k]), high[k])
    real, foretold = moved - values, 0.0
    for i in range(values.size):
        foretold += 2.0 * gradient[i] * real[i]
        for j in range(values.size):
            foretold -= real[i] * normal[i, j] * real[j]
    return moved, foretold


@njit(cache=True)
def added(columns, along, weights):  # type: ignore[no-untyped-def]
    """Columns (n, p) and the outer product of (n,) and (p,)."""
    out = columns.copy()
    for i in range(along.size):
        for k in range(weights.size):
            out[i, k] += along[i] * weights[k]
    return out

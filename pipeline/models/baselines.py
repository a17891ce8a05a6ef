"""What one would try first: models that know no mechanism, fitted beside the diagnosis.

Each maps commands U (n, k), of which the first moves the measurement most, to a measurement (n,);
all that have a memory begin at the first row. `fit` sees training rows only.
"""

import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import nnls
from sklearn.exceptions import ConvergenceWarning
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel
from sklearn.linear_model import LinearRegression, Ridge
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import PolynomialFeatures, StandardScaler

from pipeline.physics.play_operator import play

PLAY_SHARES = np.concatenate([[0.0], np.geomspace(0.002, 0.6, 40)])
BANK_SHARES = np.concatenate([[0.0], np.geomspace(0.01, 0.7, 14)])
SWEEPS = 4
DEGREE = 5
MOST_GP_ROWS = 400


Predict = Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Baseline:
    """A model by its name: `predict` answers for all rows what was fitted to some."""

    name: str
    predict: Predict


def offset_and_gain(simulation: np.ndarray, measured: np.ndarray, train: np.ndarray) -> np.ndarray:
    """The simulation (n,) with its own gain and offset refitted, (n,)."""
    return _regressed(simulation[:, None], measured, train)


def linear(commands: np.ndarray, measured: np.ndarray, train: np.ndarray) -> np.ndarray:
    """Linear in all commands."""
    return _regressed(commands, measured, train)


def polynomial(commands: np.ndarray, measured: np.ndarray, train: np.ndarray) -> np.ndarray:
    """Polynomial of degree 5 in the first command, 2 in all of them (ridge on standardised)."""
    columns = [PolynomialFeatures(2, include_bias=False).fit_transform(_unit(commands))]
    first = _unit(commands)[:, :1]
    columns += [first**power for power in range(3, DEGREE + 1)]
    model = make_pipeline(StandardScaler(), Ridge(1e-3))
    features = np.hstack(columns)
    return model.fit(features[train], measured[train]).predict(features)


def own_play(commands: np.ndarray, measured: np.ndarray, train: np.ndarray) -> np.ndarray:
    """Play of the first command, of the width that fits best, with gain and offset."""
    return _played(commands[:, :1], measured, train)


def coupled_play(commands: np.ndarray, measured: np.ndarray, train: np.ndarray) -> np.ndarray:
    """Play of each command, each of its own width, added up with gains of either sign."""
    return _played(commands, measured, train)


def prandtl_ishlinskii(commands: np.ndarray, measured: np.ndarray, train: np.ndarray) -> np.ndarray:
    """A bank of plays of each command with non-negative weights, in the direction of its gain.

    Source: Kuhnen, European J. Control 9 (2003) 407, without the superposed dead zones.
    """
    return _banked(commands, np.zeros((len(commands), 0)), measured, train)


def prandtl_ishlinskii_and_time(
    timed: np.ndarray, measured: np.ndarray, train: np.ndarray
) -> np.ndarray:
    """The same bank beside a linear drift; the last column of `timed` is the time in s."""
    return _banked(timed[:, :-1], timed[:, -1:], measured, train)


def gaussian_process(commands: np.ndarray, measured: np.ndarray, train: np.ndarray) -> np.ndarray:
    """Gaussian process over commands and their directions, on at most 400 rows evenly chosen."""
    direction = np.sign(np.diff(commands, axis=0, prepend=commands[:1]))
    features = np.hstack([_unit(commands), 0.5 * direction])
    rows = np.flatnonzero(train)
    rows = rows[np.linspace(0, len(rows) - 1, min(len(rows), MOST_GP_ROWS)).astype(int)]
    scale = np.ones(features.shape[1])
    kernel = ConstantKernel(1.0) * RBF(scale, (0.05, 1e3)) + WhiteKernel(0.05, (1e-4, 2.0))
    model = GaussianProcessRegressor(kernel, normalize_y=True, random_state=0)
    with warnings.catch_warnings():  # a length at its bound only says that an input has no say
        warnings.simplefilter("ignore", ConvergenceWarning)
        return model.fit(features[rows], measured[rows]).predict(features)


MODELS = (
    Baseline("linear in all commands", linear),
    Baseline("polynomial", polynomial),
    Baseline("Gaussian process", gaussian_process),
    Baseline("own play", own_play),
    Baseline("coupled play", coupled_play),
    Baseline("Prandtl-Ishlinskii bank", prandtl_ishlinskii),
)
# Of these the inputs are the commands and, last, the time in s.
TIMED_MODELS = (
    Baseline("linear in all commands and time", linear),
    Baseline("Prandtl-Ishlinskii bank and time", prandtl_ishlinskii_and_time),
)


def strongest_first(
    commands: Sequence[np.ndarray], measured: np.ndarray, train: np.ndarray
) -> np.ndarray:
    """Commands that move, (n, k), the one that alone explains most of the training rows first."""
    moving = [c for c in commands if float(np.ptp(c[train])) > 0.0]
    if not moving:
        return np.zeros((len(measured), 0))
    left = [np.var((measured - _regressed(c[:, None], measured, train))[train]) for c in moving]
    return np.column_stack([moving[k] for k in np.argsort(left, kind="stable")])


def _regressed(features: np.ndarray, measured: np.ndarray, train: np.ndarray) -> np.ndarray:
    return LinearRegression().fit(features[train], measured[train]).predict(features)


def _unit(commands: np.ndarray) -> np.ndarray:
    return commands / np.maximum(np.std(commands, axis=0), 1e-300)


def _banked(
    commands: np.ndarray, lines: np.ndarray, measured: np.ndarray, train: np.ndarray
) -> np.ndarray:
    """Plays of the commands (n, k) in the direction of their gain, `lines` (n, m) in either."""
    inputs = np.hstack([commands, lines])
    signs = np.sign(LinearRegression().fit(inputs[train], measured[train]).coef_)
    free = np.column_stack([np.ones(len(commands)), lines])
    columns = [free, -free]
    for k in range(commands.shape[1]):
        command = np.ascontiguousarray(commands[:, k])
        span = float(np.ptp(command[train]))
        columns += [
            (signs[k] or 1.0) * play(command, 0.5 * share * span, float(command[0]))
            for share in BANK_SHARES
        ]
    features = np.column_stack(columns)
    weights = nnls(features[train], measured[train])[0]
    return features @ weights


def _played(commands: np.ndarray, measured: np.ndarray, train: np.ndarray) -> np.ndarray:
    """Plays of all commands and a line through them; widths by turns over a grid."""
    widths = np.zeros(commands.shape[1], dtype=int)
    banks = [
        [play(np.ascontiguousarray(u), 0.5 * share * float(np.ptp(u[train])), float(u[0]))
         for share in PLAY_SHARES]
        for u in commands.T
    ]  # fmt: skip
    best = np.inf
    for _ in range(SWEEPS):
        before = widths.copy()
        for k in range(len(widths)):
            for place in range(len(PLAY_SHARES)):
                trial = widths.copy()
                trial[k] = place
                error = _error(banks, trial, measured, train)
                if error < best:
                    best, widths = error, trial
        if np.array_equal(before, widths):
            break
    features = np.column_stack([bank[w] for bank, w in zip(banks, widths, strict=True)])
    return _regressed(features, measured, train)


def _error(
    banks: Sequence[Sequence[np.ndarray]],
    widths: np.ndarray,
    measured: np.ndarray,
    train: np.ndarray,
) -> float:
    columns = [bank[w][train] for bank, w in zip(banks, widths, strict=True)]
    features = np.column_stack([*columns, np.ones(int(train.sum()))])
    weights = np.linalg.lstsq(features, measured[train], rcond=None)[0]
    return float(np.sum((measured[train] - features @ weights) ** 2))

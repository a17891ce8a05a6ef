"""What a simulation may have beside its curve: the sizes of each kind that suit it best."""

from collections.abc import Callable, Iterator
from functools import partial
from typing import NamedTuple

import numpy as np
from scipy.optimize import minimize

from pipeline.discrepancy.problem.course_trial import NOTHING, Trial
from pipeline.physics.arriving_late import LARGEST
from pipeline.physics.backlash import Backlash
from pipeline.physics.creep import Creep
from pipeline.physics.friction import Friction
from pipeline.physics.held import STEP_AND_WAIT_S
from pipeline.physics.mechanism import OwnCourse
from pipeline.physics.piece import Piece
from pipeline.physics.response_lag import ResponseLag
from pipeline.physics.second_order_lag import SecondOrderLag
from pipeline.physics.term import Term
from pipeline.physics.yielding_play import YieldingPlay

SIZES, DAMPINGS = 14, (0.4, 0.7, 1.0)
SHORTEST, LONGEST, NARROWEST, WIDEST = 0.1, 0.05, 1e-3, 0.4
QUICKLY, HIGHEST, LEAST_DAMPED, MOST_DAMPED = 0.2, 6.0, 0.05, 5.0
SHARES, SLOWEST = (0.05, 0.2), 0.3
REACHES, RELEASES = (0.6, 1.2, 2.5), (0.05, 0.8)
FINELY = {"maxiter": 160, "xatol": 1e-4, "fatol": 1e-6}


class Kind(NamedTuple):
    """A term, sizes (k, p) to begin from, positive, and the values that sizes (p,) stand for."""

    term: Term
    starts: np.ndarray
    told: Callable[[np.ndarray], np.ndarray] = lambda sizes: sizes

    def piece(self, logs: np.ndarray) -> Piece:
        """The term in the sizes of which these are the logarithms, (p,)."""
        return Piece(self.term, self.told(np.exp(logs)))


def kinds(trial: Trial) -> Iterator[Kind]:
    """All that one piece may be, the plainest first."""
    dwell_s, widths = trial.dwell_s, widths_of(trial)
    forms = forms_of(trial)
    for form in forms:
        yield Kind(ResponseLag(form), lags_of(trial)[:, None])
    yield Kind(Backlash(), widths[:, None])
    if dwell_s < STEP_AND_WAIT_S:
        yield Kind(YieldingPlay(), np.array([[width, QUICKLY * dwell_s] for width in widths]))
    yield swinging(trial, lags_of(trial))
    yield Kind(Friction("driven"), rubbing(widths), lambda x: within(x, 1.0))
    lasted_s = float(trial.time_s[-1] - trial.time_s[0])
    slow = np.geomspace(max(dwell_s, 1e-9), SLOWEST * max(lasted_s, 1e-9), SIZES // 2)
    parts = np.array([[share, late_s] for share in SHARES for late_s in slow])
    yield Kind(Creep(forms[0]), parts, lambda x: np.array([min(x[0], LARGEST), x[1]]))


def single(trial: Trial) -> Iterator[OwnCourse]:
    """The courses of one piece, of each kind the best, the plainest first."""
    for kind in kinds(trial):
        yield best(trial, partial(alone, kind), np.log(kind.starts))
    for found in (trial.rubbing_at_drive(), trial.rubbing_at_joint()):
        if found is not None:
            yield found


def alone(kind: Kind, logs: np.ndarray) -> OwnCourse:
    """The course of one piece, before the curve or behind it as its term is."""
    piece = kind.piece(logs)
    return OwnCourse(drive=(piece,)) if piece.term.before_curve else OwnCourse(curve=(piece,))


def best(
    trial: Trial, own: Callable[[np.ndarray], OwnCourse | None], starts: np.ndarray
) -> OwnCourse:
    """The course that leaves least, of logarithms of sizes: the best start, (k, p), refined."""

    span = float(np.ptp(trial.simulated))

    def left(logs: np.ndarray) -> float:
        return trial.left(own(logs) or NOTHING) / span

    begun = min(starts, key=left)
    found = minimize(left, begun, method="Nelder-Mead", options=FINELY)
    return own(found.x) or NOTHING


def forms_of(trial: Trial) -> list[str]:
    """How a command goes from sample to sample, as forms of what comes late say it."""
    return ["whole"] if trial.dwell_s >= STEP_AND_WAIT_S else ["running", "whole"]


def lags_of(trial: Trial) -> np.ndarray:
    """Time constants [s] to begin from."""
    lasted_s = float(trial.time_s[-1] - trial.time_s[0])
    return np.geomspace(SHORTEST * max(trial.dwell_s, 1e-9), LONGEST * max(lasted_s, 1e-9), SIZES)


def widths_of(trial: Trial) -> np.ndarray:
    """Widths [command's unit] to begin from."""
    return np.ptp(trial.command) * np.geomspace(NARROWEST, WIDEST, SIZES)


def swinging(trial: Trial, lags_s: np.ndarray) -> Kind:
    """Lags of second order about as late as some others (k,)."""
    moving, most = float(trial.dwell_s < STEP_AND_WAIT_S), HIGHEST / max(trial.dwell_s, 1e-9)
    paces = np.array([[1.0 / lag_s, damping] for lag_s in lags_s for damping in DAMPINGS])
    return Kind(
        SecondOrderLag(),
        paces,
        lambda x: np.array([min(x[0], most), np.clip(x[1], LEAST_DAMPED, MOST_DAMPED), moving]),
    )


def rubbing(widths: np.ndarray) -> np.ndarray:
    """Widths, reaches and shapes of friction to begin from, (k, 3), from few of some widths."""
    return np.array([[w, share * w, s] for w in widths[::2] for share in REACHES for s in RELEASES])


def within(sizes: np.ndarray, most: float) -> np.ndarray:
    """Sizes (k,) of which the last one is no larger than can be."""
    return np.append(sizes[:-1], min(sizes[-1], most))

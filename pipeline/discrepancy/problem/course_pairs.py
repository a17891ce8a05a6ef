"""What a simulation may have beside its curve: what comes late, and play or friction besides."""

from collections.abc import Callable

import numpy as np

from pipeline.discrepancy.problem.course_pieces import (
    Kind,
    best,
    forms_of,
    lags_of,
    swinging,
    widths_of,
)
from pipeline.discrepancy.problem.course_trial import Trial
from pipeline.physics.backlash import Backlash
from pipeline.physics.mechanism import OwnCourse
from pipeline.physics.piece import Piece
from pipeline.physics.response_lag import ResponseLag

EVERY = 2  # of the sizes that one piece alone begins from
QUICKER = np.array([0.5, 1.0])
EXACTLY, NEARLY = 2e-4, 2.5

Pair = Callable[[Trial, Piece, np.ndarray], OwnCourse | None]


def pairs(trial: Trial) -> list[OwnCourse]:
    """The courses of two pieces, the best of each kind.

    Where none leaves next to nothing, a lag of second order stands in the place of one of first
    order in those that leave least, begun about as late.
    """
    widths = widths_of(trial)[::EVERY]
    lags = [Kind(ResponseLag(form), lags_of(trial)[::EVERY, None]) for form in forms_of(trial)]
    found = {pair: [paired(trial, pair, lag, widths) for lag in lags] for pair in PAIRS}
    firsts = {pair: min(own, key=trial.left) for pair, own in found.items()}
    least = min(map(trial.left, firsts.values()))
    if least > EXACTLY * np.ptp(trial.simulated):
        for pair, own in firsts.items():
            if own.pieces and trial.left(own) < NEARLY * least:
                late = next(p for p in own.pieces if p.term.name == ResponseLag.name)
                swing = swinging(trial, QUICKER * late.values[0])
                found[pair].append(paired(trial, pair, swing, widths))
    return [own for kind in found.values() for own in kind]


def paired(trial: Trial, pair: Pair, lag: Kind, widths: np.ndarray) -> OwnCourse:
    """The best course of a kind of lag, beside what may have one of some widths (k,)."""
    starts, size = np.log(lag.starts), lag.starts.shape[1]
    if pair in WIDE:
        starts = np.array([[*start, np.log(width)] for start in starts for width in widths])
    return best(trial, lambda logs: pair(trial, lag.piece(logs[:size]), logs[size:]), starts)


def joint_behind(trial: Trial, lag: Piece, logs: np.ndarray) -> OwnCourse | None:
    """A joint that rubs, of a wire that comes late."""
    return trial.rubbing_at_joint(OwnCourse(curve=(lag,)))


def joint_before(trial: Trial, lag: Piece, logs: np.ndarray) -> OwnCourse | None:
    """A joint that rubs, seen late."""
    return trial.rubbing_at_joint(OwnCourse(sensor=(lag,)))


def friction_behind(trial: Trial, lag: Piece, logs: np.ndarray) -> OwnCourse | None:
    """A drive that comes late, and rubs."""
    return trial.rubbing_at_drive(OwnCourse(drive=(lag,)))


def friction_before(trial: Trial, lag: Piece, logs: np.ndarray) -> OwnCourse | None:
    """A drive that rubs, of a wire that comes late."""
    return trial.rubbing_at_drive(OwnCourse(curve=(lag,)))


def play_behind(trial: Trial, lag: Piece, logs: np.ndarray) -> OwnCourse:
    """A drive that comes late, and has play of a width of that logarithm."""
    return OwnCourse(drive=(lag, Piece(Backlash(), np.exp(logs))))


def play_before(trial: Trial, lag: Piece, logs: np.ndarray) -> OwnCourse:
    """Play of a width of that logarithm before a wire that comes late."""
    return OwnCourse(drive=(Piece(Backlash(), np.exp(logs)),), curve=(lag,))


WIDE = (play_behind, play_before)
PAIRS = (*WIDE, joint_behind, joint_before, friction_behind, friction_before)

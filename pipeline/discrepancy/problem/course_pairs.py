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

Pair = Callable[..., OwnCourse | None]  # of a lag, and of play or of the trial


def pairs(trial: Trial) -> list[OwnCourse]:
    """The courses of two pieces, the best of each kind.

    Where none leaves next to nothing, a lag of second order stands in the place of one of first
    order in those that leave least, begun about as late.
    """
    widths = widths_of(trial)[::EVERY]
    lags = [Kind(ResponseLag(form), lags_of(trial)[::EVERY, None]) for form in forms_of(trial)]
    found = {
        pair: [paired(trial, pair, lag, widths) for lag in lags] for pair in (*WITH_PLAY, *RUBBING)
    }
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
    """The best course of a kind of lag, beside play of about some widths (k,) where it has play."""
    starts, size = np.log(lag.starts), lag.starts.shape[1]
    if pair in WITH_PLAY:
        starts = np.array([[*start, np.log(width)] for start in starts for width in widths])

    def own(logs: np.ndarray) -> OwnCourse | None:
        late, wide = lag.piece(logs[:size]), np.exp(logs[size:])
        return pair(late, Piece(Backlash(), wide)) if len(wide) else pair(late, trial)

    return best(trial, own, starts)


def play_behind(lag: Piece, play: Piece) -> OwnCourse:
    """A drive that comes late, and has play."""
    return OwnCourse(drive=(lag, play))


def play_before(lag: Piece, play: Piece) -> OwnCourse:
    """Play before a wire that comes late."""
    return OwnCourse(drive=(play,), curve=(lag,))


def joint_behind(lag: Piece, trial: Trial) -> OwnCourse | None:
    """A joint that rubs, of a wire that comes late."""
    return trial.rubbing_at_joint(OwnCourse(curve=(lag,)))


def joint_before(lag: Piece, trial: Trial) -> OwnCourse | None:
    """A joint that rubs, seen late."""
    return trial.rubbing_at_joint(OwnCourse(sensor=(lag,)))


def friction_behind(lag: Piece, trial: Trial) -> OwnCourse | None:
    """A drive that comes late, and rubs."""
    return trial.rubbing_at_drive(OwnCourse(drive=(lag,)))


def friction_before(lag: Piece, trial: Trial) -> OwnCourse | None:
    """A drive that rubs, of a wire that comes late."""
    return trial.rubbing_at_drive(OwnCourse(curve=(lag,)))


WITH_PLAY: tuple[Pair, ...] = (play_behind, play_before)
RUBBING: tuple[Pair, ...] = (joint_behind, joint_before, friction_behind, friction_before)

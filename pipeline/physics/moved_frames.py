"""Old frames of a robot whose moves go at a steady speed: a larger step takes longer."""

from collections.abc import Sequence
from itertools import product

import numpy as np

from pipeline.physics.frame_lag import MOST_ROWS, MOST_S, NO_ROWS, FrameLag, held_at
from pipeline.physics.held import uneven
from pipeline.physics.motion import Motion
from pipeline.physics.moved_lag import usual_speeds
from pipeline.physics.slewing_motor import fastest
from pipeline.physics.term import Parameter, Surroundings, Told

MOVED, BLURRED = "moved", "blurred"
WAITS, QUICKER, PARTS = (0.05, 0.5), (1.0, 2.0, 4.0, 10.0), (0.3, 0.6, 1.0)
LARGER, LONGEST, SHARES, USUAL = 1.2, 2.0, (0.1, 0.4), (0.1, 0.5, 0.9)


class MovedFrames(FrameLag):
    """seen(t) = theta(t - lag), each pose reached at `speed` after the sample before, then held.

    Where waits differ an old frame shows a move on its way only after short ones, and where steps
    differ more of it after large ones: no share of a dwell, and no time for all moves, says that.
    Form "blurred": a move takes `move` besides, and what is seen is the mean over the `blur`
    before: an exposure, or the ramps of a move. Source: pure delay of a buffered camera;
    trapezoidal profile of a positioning drive (its ramps are a mean over their time).
    """

    unlikely = 3.0  # else chance would decide against moves that all take the same time

    def __init__(self, form: str = MOVED) -> None:
        super().__init__(form)

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        dwell, most = max(around.dwell_s, 1e-9), fastest(around)
        lag = Parameter("lag", "s", 0.0, max(MOST_ROWS * dwell, MOST_S), dwell, dwell)
        low, unit = 1e-3 * most, f"{around.drive_unit}/s"
        speed = Parameter("speed", unit, low, most, 0.1 * most, 0.0, relative=True)
        if self.form == MOVED:
            return lag, speed
        longest, usual = LONGEST * dwell, 0.1 * dwell
        move = Parameter("move", "s", 0.0, longest, usual, 0.0)
        return lag, speed, move, Parameter("blur", "s", 0.0, longest, usual, dwell)

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        lag, speed, least, blur = (*values, 0.0, 0.0)[:4]
        kept = (NO_ROWS, NO_ROWS, NO_ROWS) if state is None else np.split(state, 3)
        now = (motion.time_s, signal, motion.drive)
        time, poses, drive = (np.concatenate(pair) for pair in zip(kept, now, strict=True))
        moves_s = least + np.abs(np.diff(drive)) / speed
        seen = held_at(motion.time_s - lag, time, poses, moves_s, float(blur))
        first = max(int(np.searchsorted(time, time[-1] - lag - blur)) - 1, 0)
        return seen, np.concatenate([time[first:], poses[first:], drive[first:]])

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        """Frames of moves on their way in the shortest waits, or in usual ones."""
        waits = np.unique(np.quantile(np.diff(motion.time_s), WAITS))
        least, shortest = min(usual_speeds(motion)), float(waits[0])
        if self.form == BLURRED:
            speeds, short = (QUICKER[2] * least, fastest(around)), shortest * np.array(SHARES)
            some = product(speeds, short, short)
            return np.array([[shortest - 0.5 * m, speed, m, blur] for speed, m, blur in some])
        rows = [
            [wait - (1.0 - part) * shortest / quicker, quicker * least]
            for wait in waits
            for quicker in QUICKER
            for part in PARTS
        ]
        return np.array(rows)

    def scaled(self, values: np.ndarray, factor: float) -> np.ndarray:
        return values

    def instead(self, values: np.ndarray, motion: Motion, around: Surroundings) -> Sequence[Told]:
        """Moves that all take the same time, that of some step here, in place of a steady speed."""
        moves_s = np.quantile(sizes_of_steps(motion), USUAL) / values[1]
        return [[(FrameLag("held"), np.array([values[0], move_s]))] for move_s in moves_s]

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        """Where waits differ, and steps: else `held` says it as well."""
        steps = sizes_of_steps(motion)
        differ = len(steps) > 0 and float(np.max(steps)) > LARGER * float(np.median(steps))
        return super().excited(motion, around) and differ and uneven(motion.time_s)


def sizes_of_steps(motion: Motion) -> np.ndarray:
    """How far each step goes that moves the drive, (k,) [drive unit]."""
    steps = np.abs(np.diff(motion.drive))
    return np.asarray(steps[steps > 0.0])

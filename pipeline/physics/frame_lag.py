"""Frame lag: the frame shows an earlier pose."""

from typing import ClassVar

import numpy as np

from pipeline.number_words import worded
from pipeline.physics.held import STEP_AND_WAIT_S, uneven
from pipeline.physics.motion import Motion
from pipeline.physics.term import Parameter, Surroundings, Term

OLD, AT_DRIVE = "force", "drive"
OF_TIME = ("time", AT_DRIVE, "held", "moved", "blurred")
MOST_ROWS, MOST_S = 10.0, 0.5
QUICKEST, LONGEST = 0.02, 2.0
MOVES = ((0.1, 1.5), (0.4, 3.0), (1.0, 5.0))
LEAST, OF_CYCLE = 2.0, 0.08


class FrameLag(Term):
    """seen(t) = theta(t - lag), straight between samples; form "frames" counts the lag in samples.

    Form "drive" is the pose that the drive asked for then, straight between its samples: where that
    goes on between them and the joint has corners, what is seen does not run straight. Form "held":
    each pose is reached within `move` of the sample before, and held from there on,
    as where a robot moves, waits and takes its frame: the wait may vary, the move does not. Form
    "force" is that of a force against motion, LEAST samples old, for less is a delay.
    Source: pure delay of a buffered camera.
    """

    name = "frame_lag"
    site = "sensor"
    place = 200.0
    remembers = "time"
    group = "lag"
    timed = True
    grows: ClassVar = {"time": ("held",), "frames": ("held",)}
    means = "the frame shows an earlier pose"
    says = "The camera's frame is old: it shows the pose of {lag} before."

    def __init__(self, form: str = "time") -> None:
        self.form = form
        self.before_curve = form == AT_DRIVE
        self.own_law = self.far_apart = form == "held"  # a plain lag says little of it
        self.place = 0.0 if self.before_curve else FrameLag.place

    @property
    def kin(self) -> str:
        return "time" if self.form == AT_DRIVE else self.form

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        if self.form == "frames":
            return (Parameter("lag", "frames", 0.0, MOST_ROWS, 1.0, 1.0),)
        dwell = max(around.dwell_s, 1e-9)
        least, most = LEAST * dwell if self.form == OLD else 0.0, longest_s(around)
        lag = Parameter("lag", "s", least, max(MOST_ROWS * dwell, most), max(dwell, least), dwell)
        if self.form in ("time", AT_DRIVE, OLD):
            return (lag,)
        quickest, longest = QUICKEST * dwell, LONGEST * dwell
        return lag, Parameter("move", "s", quickest, longest, 0.1 * dwell, 0.0)

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        kept_time, kept = (NO_ROWS, NO_ROWS) if state is None else np.split(state, 2)
        time, poses = np.concatenate([kept_time, motion.time_s]), np.concatenate([kept, signal])
        at = np.arange(len(time), dtype=float) if self.form == "frames" else time
        asked = at[len(kept) :] - values[0]
        if self.form == "held":
            seen = held_at(asked, at, poses, values[1])
        else:
            seen = np.interp(asked, at, poses)
        first = max(int(np.searchsorted(at, at[-1] - values[0])) - 1, 0)
        return seen, np.concatenate([time[first:], poses[first:]])

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        if self.form == "frames":
            return np.array([[0.3], [1.0], [2.0], [4.0]])
        dwell = max(around.dwell_s, 1e-9)
        if self.form == "held":
            rows = [[lag, m] for m, most in MOVES for lag in np.arange(0.5 * m, most, 0.5 * m)]
            return dwell * np.array(rows)
        shares = [0.3, 1.0, 2.0, 4.0] if self.form != OLD else [3.0]
        while 2.0 * shares[-1] * dwell < longest_s(around):
            shares.append(2.0 * shares[-1])
        return dwell * np.array(shares)[:, None]

    def scaled(self, values: np.ndarray, factor: float) -> np.ndarray:
        """As they are of poses that are held: of a pose held for longer no lag shows anything."""
        return values if self.form == "held" else super().scaled(values, factor)

    def sentence(self, values: np.ndarray, around: Surroundings) -> str:
        if self.form == OLD:
            return f"The force is old: it is that of {worded(values[0])} s before."
        return super().sentence(values, around)

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        moves = around.drive_span > 0.0 and around.dwell_s > 0.0
        if self.form == AT_DRIVE:
            return moves and around.dwell_s < STEP_AND_WAIT_S
        return moves and (self.form in ("time", OLD) or uneven(motion.time_s))


def held_at(
    asked_s: np.ndarray,
    time_s: np.ndarray,
    poses: np.ndarray,
    moves_s: np.ndarray | float,
    over_s: float = 0.0,
) -> np.ndarray:
    """Poses at some times, or their means over some time before each.

    Each pose is reached within its move of the time before, straight, and then held.
    """
    reached = time_s[:-1] + np.minimum(moves_s, np.diff(time_s))
    times = np.concatenate([time_s[:1], np.column_stack([reached, time_s[1:]]).ravel()])
    values = np.concatenate([poses[:1], np.repeat(poses[1:], 2)])
    if over_s == 0.0:
        return np.interp(asked_s, times, values)
    return (passed(asked_s, times, values) - passed(asked_s - over_s, times, values)) / over_s


def passed(asked: np.ndarray, times: np.ndarray, values: np.ndarray) -> np.ndarray:
    """The integral, from the first time to some, of what runs straight between values at times."""
    if len(times) == 1:
        return np.asarray(values[0] * (asked - times[0]))
    taken = np.diff(times)
    whole = np.concatenate([[0.0], np.cumsum(0.5 * (values[1:] + values[:-1]) * taken)])
    k = np.clip(np.searchsorted(times, asked) - 1, 0, len(times) - 2)
    since, slope = asked - times[k], np.diff(values)[k] / np.maximum(taken[k], 1e-12)
    inside = np.clip(since, 0.0, taken[k])
    return np.asarray(
        whole[k] + inside * (values[k] + 0.5 * slope * inside)
        + np.minimum(since, 0.0) * values[0] + np.maximum(since - taken[k], 0.0) * values[-1]
    )  # fmt: skip


def longest_s(around: Surroundings) -> float:
    """How old a frame may be [s], however finely sampled: of a motion that goes on, of its cycle.

    Of one that steps and waits samples are the measure.
    """
    goes_on = around.dwell_s < STEP_AND_WAIT_S
    return max(MOST_S, OF_CYCLE * around.period_s) if goes_on else MOST_S


NO_ROWS = np.zeros(0)

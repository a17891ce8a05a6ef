"""Frames from a queue: they are older and older until it is emptied, again and again."""

import numpy as np

from pipeline.number_words import worded
from pipeline.physics.frame_lag import FrameLag
from pipeline.physics.motion import Motion
from pipeline.physics.term import Parameter, Surroundings, Term

SHORTEST, LONGEST, MOST = 20.0, 400.0, 20.0


def late_by(rows: np.ndarray, values: np.ndarray) -> np.ndarray:
    """How many samples late the frames of some samples (n,) are."""
    rise, every, turn, floor = values
    return np.asarray(np.rint(rise * (floor + (rows / every + turn) % 1.0)).astype(int))


class QueuedFrames(Term):
    """seen_k = theta_(k - l_k), l_k = round(rise (floor + frac(k / every + turn))) samples.

    A reader that is slower than its camera: frames wait in a buffer, which is flushed once it is
    full. k counts the recording's samples. Source: definition (a finite queue that is served too
    slowly and then emptied is a sawtooth).
    """

    name = FrameLag.name
    site = FrameLag.site
    place = FrameLag.place
    remembers = FrameLag.remembers
    group = FrameLag.group
    timed = FrameLag.timed
    evolves = True
    unlikely = 3.0
    form = "queue"
    says = "The camera's frames wait in a queue: they get older by {rise}"

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        return (
            Parameter("rise", "frames", 0.0, MOST, 3.0, 5.0),
            Parameter("every", "frames", SHORTEST, LONGEST, 100.0, 20.0),
            Parameter("turn", "", -1.0, 2.0, 0.5, 1.0),
            Parameter("floor", "", 0.0, 2.0, 0.3, 1.0),
        )

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        rise, _, _, floor = values
        count, kept = (0, signal[:0]) if state is None else (int(state[0]), state[1:])
        poses, rows = np.concatenate([kept, signal]), np.arange(len(signal))
        seen = poses[np.maximum(len(kept) + rows - late_by(count + rows, values), 0)]
        longest = int(np.ceil(rise * (floor + 1.0)))
        return seen, np.concatenate([[count + len(signal)], poses[max(len(poses) - longest, 0) :]])

    def leaps(self, motion: Motion, angle: np.ndarray, values: np.ndarray) -> np.ndarray:
        late = late_by(np.arange(-1, len(motion) + 1), values)
        emptied = np.diff(late) < 0
        return emptied[:-1] | emptied[1:]

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        return len(motion) > LONGEST and FrameLag().excited(motion, around)

    def sentence(self, values: np.ndarray, around: Surroundings) -> str:
        every = f"{worded(values[1])} frames"
        return f"{super().sentence(values, around)} and are then new again, every {every}."

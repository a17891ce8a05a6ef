"""How a motion begins: where the recording of a model ended, as it began, or nobody knows how."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from pipeline.physics.mechanism import Mechanism, State
from pipeline.physics.motion import Kinetics, Motion

MOST_ROWS = 2000
WHOLE, PAUSE = 0.9, 0.1


@dataclass(frozen=True)
class End:
    """Both ends of a recording and what its mechanism remembers after it.

    first, last, low, high: drive; time_s, cycle: of the last row; whole: whether that cycle was
    over. lasted_s: from its first row to its last. longest_s, farthest: the most time and way
    between two rows.
    """

    first: float
    last: float
    low: float
    high: float
    time_s: float
    cycle: int
    whole: bool
    lasted_s: float
    longest_s: float
    farthest: float
    state: State

    def goes_on(self, motion: Motion) -> bool:
        """Whether a motion begins where the recording ended, at once or after a short pause."""
        past_s = float(motion.time_s[0]) - self.time_s
        near = abs(float(motion.drive[0]) - self.last) <= 2.0 * self.farthest
        return 0.0 < past_s <= max(2.0 * self.longest_s, PAUSE * self.lasted_s) and near

    def begins_alike(self, motion: Motion) -> bool:
        """Whether a motion begins at the command at which the recording did."""
        return abs(float(motion.drive[0]) - self.first) <= self.farthest

    def answer(self, mechanism: Mechanism, motion: Motion) -> np.ndarray:
        """What a mechanism says, (n,), of a motion that goes on.

        Its cycles go on, too, be they numbered so or from 0.
        """
        begins, following = int(motion.cycle[0]), self.cycle + self.whole
        if begins not in (following, self.cycle) or begins == 0:
            motion = replace(motion, cycle=motion.cycle - begins + following)
        return mechanism.respond(motion, self.state)[0]

    def as_json(self) -> dict[str, Any]:
        """The same as plain JSON."""
        state = {key: np.asarray(own).tolist() for key, own in self.state.items()}
        return {**self.__dict__, "state": state}


def end_of(motion: Motion, mechanism: Mechanism) -> End:
    """The end of a recording whose mechanism followed its motion."""
    return End(
        first=float(motion.drive[0]),
        last=float(motion.drive[-1]),
        low=float(motion.drive.min()),
        high=float(motion.drive.max()),
        time_s=float(motion.time_s[-1]),
        cycle=int(motion.cycle[-1]),
        whole=last_is_whole(motion.cycle),
        lasted_s=float(motion.time_s[-1] - motion.time_s[0]),
        longest_s=float(np.max(np.diff(motion.time_s))),
        farthest=float(np.max(np.abs(np.diff(motion.drive)))),
        state=mechanism.respond(motion)[1],
    )


def last_is_whole(cycle: np.ndarray) -> bool:
    """Whether the last cycle has about as many rows as the others; cycle: its number, (n,)."""
    rows = np.unique(cycle, return_counts=True)[1]
    return bool(rows[-1] >= WHOLE * np.median(rows))


def end_from_json(entry: Mapping[str, Any]) -> End:
    """What `End.as_json` wrote."""
    state = {k: np.array(v, dtype=float) for k, v in entry["state"].items()}
    return End(**{**entry, "state": state})


def variance_of_start(
    mechanism: Mechanism, motion: Motion, expected: np.ndarray, known: End
) -> np.ndarray:
    """How far answers (n,) may be off for want of what was before a motion, squared.

    Play and friction hang on the way that led to the first row: it is taken from either end of
    where the drive is known to go, at its usual speed.
    """
    low, high = float(motion.drive.min()), float(motion.drive.max())
    ends = (min(low, known.low), max(high, known.high))
    found = [mechanism.respond(motion, _led(mechanism, motion, known, end))[0] for end in ends]
    return np.asarray(0.5 * sum((answer - expected) ** 2 for answer in found))


def _led(mechanism: Mechanism, motion: Motion, known: End, begin: float) -> State:
    """What a mechanism remembers that a straight way from `begin` led to a motion's first row."""
    to, step, dwell_s = float(motion.drive[0]), known.farthest, known.longest_s
    if len(motion) > 1 and np.ptp(motion.drive) > 0.0:
        step = float(np.mean(np.abs(np.diff(motion.drive))))
        dwell_s = float(np.median(np.diff(motion.time_s)))
    rows = int(np.clip(np.ceil(abs(to - begin) / max(step, 1e-300)), 1, MOST_ROWS))
    still = np.ones(rows)
    before = Motion(
        drive=np.linspace(begin, to, rows + 1)[:-1],
        time_s=motion.time_s[0] + dwell_s * np.arange(-rows, 0),
        cycle=np.full(rows, motion.cycle[0]),
        others={name: values[0] * still for name, values in motion.others.items()},
        radian=motion.radian,
        zeros=motion.zeros,
        kinetics=_steady(motion.kinetics, (to - begin) / rows / dwell_s, still),
    )
    after = mechanism.respond(before)[1]
    of_the_clock = {p.key for p in mechanism.pieces if p.term.slow}
    return {key: own for key, own in after.items() if key not in of_the_clock}


def _steady(kinetics: Kinetics | None, speed: float, still: np.ndarray) -> Kinetics | None:
    if kinetics is None:
        return None
    return Kinetics(speed * still, 0.0 * still, kinetics.simulated[0] * still)

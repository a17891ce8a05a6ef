"""A mechanism: terms in their order, from the drive to what the sensor says."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from pipeline.physics.balance import BALANCE, settle
from pipeline.physics.kinematics import Curve, IdentityCurve, SmoothError
from pipeline.physics.motion import Motion
from pipeline.physics.own_amount import as_load, changed
from pipeline.physics.piece import Piece


@dataclass(frozen=True)
class OwnCourse:
    """What a simulation itself has beside its curve, in the order in which a drive meets it.

    drive: before the curve, as a motor's lag or play. curve: behind it. joint: in the balance.
    sensor: behind that, as a filter's lag. shaft: ahead of all that terms do to the drive, which
    come between it and `drive`. farther: how many times as far what is in the balance moves the
    joint as it does in the simulation.
    """

    drive: tuple[Piece, ...] = ()
    curve: tuple[Piece, ...] = ()
    joint: tuple[Piece, ...] = ()
    sensor: tuple[Piece, ...] = ()
    shaft: tuple[Piece, ...] = ()
    farther: float = field(default=1.0, kw_only=True)

    @property
    def pieces(self) -> tuple[Piece, ...]:
        """All of them."""
        return (*self.shaft, *self.drive, *self.curve, *self.joint, *self.sensor)

    @property
    def seen_late(self) -> "OwnCourse":
        """The same with what is behind the curve behind the joint instead."""
        return replace(self, curve=(), sensor=(*self.sensor, *self.curve))

    @property
    def moved_first(self) -> "OwnCourse":
        """The same with what is before the curve ahead of what terms do there."""
        return replace(self, drive=(), shaft=(*self.shaft, *self.drive))

    @property
    def under_load(self) -> "OwnCourse | None":
        """The same with what is late behind the curve in the balance; None where that is none."""
        loads = [as_load(piece) for piece in self.curve]
        if not loads or None in loads:
            return None
        return replace(self, curve=(), joint=(*self.joint, *(p for p in loads if p)))

    def as_changed(self, pieces: Sequence[Piece]) -> "OwnCourse":
        """The same with as much of each as pieces say, see `own_amount.py`."""
        own = (changed(getattr(self, place), pieces) for place in PLACES)
        return OwnCourse(*own, farther=self.farther)


PLACES = "drive", "curve", "joint", "sensor", "shaft"
State = Mapping[str, np.ndarray]
COURSE = "course"


@dataclass(frozen=True)
class Trace:
    """asked: (n,) the angle that the wire asks for. body: (n,) the joint's angle in balance.

    seen: (n,) what the sensor makes of it. added: (n,) the part of `seen` that no gain of the
    simulation scales: what terms add to a force. beside: traces with one parameter a step further,
    by its number among all, as far as they were asked for.
    """

    asked: np.ndarray
    body: np.ndarray
    seen: np.ndarray
    state: State
    added: np.ndarray | None = None
    beside: dict[int, "Trace"] = field(default_factory=dict, repr=False, compare=False)

    def rows(self, wanted: np.ndarray) -> "Trace":
        """The same in some of its rows (indices)."""
        added = None if self.added is None else self.added[wanted]
        asked, body, seen = (x[wanted] for x in (self.asked, self.body, self.seen))
        return Trace(asked, body, seen, self.state, added)


@dataclass(frozen=True)
class Mechanism:
    """drive -> drive terms -> nominal curve -> balance at the joint -> joint and sensor terms.

    Terms that are in balance (friction, compliance, gravity, contact, stop) meet in one implicit
    equation, see `balance.py`. The answer is gain * seen + offset + error(seen). Where a force is
    measured against the motion, terms add to the simulated force and the gain is that of the
    simulation: gain * simulated + offset + what the terms add.
    """

    curve: Curve = field(default_factory=IdentityCurve)
    pieces: Sequence[Piece] = ()
    gain: float = 1.0
    offset: float = 0.0
    error: SmoothError | None = None
    course: OwnCourse | None = None

    def respond(self, motion: Motion, state: State | None = None) -> tuple[np.ndarray, State]:
        """The angle of each sample, shape (n,), and the state after the last one.

        Given the state of the block before, a block answers as if all had come at once.
        """
        trace = self.trace(motion, state)
        answer = self.gain * trace.seen + self.offset
        if trace.added is not None:
            answer += (1.0 - self.gain) * trace.added
        if self.error is not None:
            answer += self.error(trace.seen, motion.others)
        return answer, trace.state

    def trace(self, motion: Motion, state: State | None = None) -> Trace:
        """The angle that the joint takes and the one that the sensor sees, before calibration."""
        if motion.corners is not None:
            whole, rows = motion.whole
            return self.trace(whole, state).rows(rows)
        before = {} if state is None else state
        after: dict[str, np.ndarray] = {}
        pieces, own = _in_order(self.pieces), self._own
        signal = np.asarray(motion.drive, dtype=float)
        signal = _through("shaft", own.shaft, signal, motion, before, after)
        for piece in pieces:
            if piece.term.before_curve:
                signal = _apply(piece, signal, motion, before, after)
        kinetics = motion.kinetics
        if kinetics is not None:
            signal = kinetics.simulated
        else:
            signal = _through("drive", own.drive, signal, motion, before, after)
            signal = _through("curve", own.curve, self.curve(signal), motion, before, after)
        return self._balanced(signal, pieces, own, motion, before, after)

    @property
    def _own(self) -> OwnCourse:
        """What the simulation itself has, as much of it as the pieces say."""
        return OwnCourse() if self.course is None else self.course.as_changed(self.pieces)

    def balanced(self, asked: np.ndarray, motion: Motion) -> Trace:
        """The same where all that the wire asks for (n,) is known."""
        return self._balanced(asked, _in_order(self.pieces), self._own, motion, {}, {})

    def sensed(self, asked: np.ndarray, body: np.ndarray, motion: Motion) -> Trace:
        """The same for a joint of which all angles (n,) are known."""
        return self._sensed(asked, body, _in_order(self.pieces), motion, {}, {})

    def _balanced(
        self,
        asked: np.ndarray,
        pieces: Sequence[Piece],
        own: OwnCourse,
        motion: Motion,
        before: State,
        after: dict[str, np.ndarray],
    ) -> Trace:
        body, balanced = asked, [p for p in pieces if p.term.in_balance]
        balanced += own.joint
        if balanced:
            body, states = settle(asked, balanced, motion, self.curve, before.get(BALANCE), before)
            after |= states
        body = _through("sensor", own.sensor, body, motion, before, after)
        return self._sensed(asked, body, pieces, motion, before, after)

    def _sensed(
        self,
        asked: np.ndarray,
        body: np.ndarray,
        pieces: Sequence[Piece],
        motion: Motion,
        before: State,
        after: dict[str, np.ndarray],
    ) -> Trace:
        seen = body
        for piece in pieces:
            if not (piece.term.before_curve or piece.term.in_balance):
                seen = _apply(piece, seen, motion, before, after)
        kinetics = motion.kinetics
        added = None if kinetics is None else seen - kinetics.simulated
        return Trace(asked, body, seen, after, added)


def _in_order(pieces: Sequence[Piece]) -> Sequence[Piece]:
    return pieces if len(pieces) < 2 else sorted(pieces, key=lambda piece: piece.term.place)


def _through(
    place: str,
    own: Sequence[Piece],
    signal: np.ndarray,
    motion: Motion,
    before: State,
    after: dict[str, np.ndarray],
) -> np.ndarray:
    """A signal behind what a simulation itself has at a place, (n,)."""
    for k, piece in enumerate(own):
        key = f"{COURSE} {place} {k}"
        signal, after[key] = piece.term.respond(signal, motion, piece.values, before.get(key))
    return signal


def _apply(
    piece: Piece,
    signal: np.ndarray,
    motion: Motion,
    before: State,
    after: dict[str, np.ndarray],
) -> np.ndarray:
    key = piece.key
    signal, after[key] = piece.term.respond(signal, motion, piece.values, before.get(key))
    return signal

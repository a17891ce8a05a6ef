"""The problem of one measurement: what drove it, what was measured, what may be fitted."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from pipeline.config import ToleranceConfig
from pipeline.discrepancy.problem.levels import Levels
from pipeline.discrepancy.problem.rows import Averaged, Picked
from pipeline.discrepancy.problem.stale import NONE_STALE, StaleSamples
from pipeline.physics.differentiation import Derivatives
from pipeline.physics.kinematics import Curve
from pipeline.physics.mechanism import Mechanism, OwnCourse, Trace
from pipeline.physics.motion import Motion
from pipeline.physics.piece import Piece
from pipeline.physics.term import Surroundings


@dataclass(frozen=True)
class Delay:
    """measured(t) = force(t - value) [s] with its 95 % interval; negative where the force leads."""

    value: float = 0.0
    low: float = 0.0
    high: float = 0.0


@dataclass(frozen=True)
class Problem:
    """Arrays are (n,). measured is NaN where nothing was measured.

    simulated: the simulation as it came. curve: of the drive, see `static`. train, heldout: masks
    that part the measured rows; `train` is all that fit, noise and choice may look at. averaged:
    the samples behind rows that are block means. picked: those behind rows that are every k-th.
    derivatives: of the position that a force is measured against. delay: by how much that force was
    recorded later than its motion. counted: the step of the encoder that counted the drive, see
    `counts.py`; rough: the noise of one that was measured, see `rough.py`; 0.0 of another. stale:
    which samples say again what the one before said. lone: samples of a force that stand alone and
    count in no mean, see `lone_samples.py`; None where the rows are no samples of one. replaced:
    the simulation as it came, where another stands in its place: a line in a command where it does
    not move, the middle of its two branches where it jumps with the direction (`jumping.py`).
    unsettled: how many measured samples come after a hole and don't count, see `holes.py`. own:
    what was taken off measured and simulated, as the simulation does it beside its curve, RMS, see
    `own_dynamics.py`. course: what the simulation surely has beside its curve (a lag, play, ...),
    see `course.py`. levels: of a sensor that reads in such. read: the measurement as it was read,
    where what readings are off by was taken off, see `levels.py`. coursed, traced: the same where
    the little that the simulation does beside its curve is a course of its own, and with its trace
    as drive. elsewhere: the same where the simulation's own friction, which may be at its drive or
    at its joint, is at the other place.
    """

    motion: Motion
    curve: Curve
    measured: np.ndarray
    simulated: np.ndarray
    train: np.ndarray
    heldout: np.ndarray
    around: Surroundings
    tolerance: ToleranceConfig
    drive: str
    static: bool
    averaged: Averaged | None = None
    picked: Picked | None = None
    derivatives: Derivatives | None = None
    delay: Delay = Delay()
    counted: float = 0.0
    rough: float = 0.0
    stale: StaleSamples = NONE_STALE
    lone: np.ndarray | None = None
    replaced: np.ndarray | None = None
    unsettled: int = 0
    own: float = 0.0
    course: OwnCourse | None = None
    levels: Levels | None = None
    read: np.ndarray | None = None
    coursed: "Problem | None" = None
    traced: "Problem | None" = None
    elsewhere: "Problem | None" = None

    @property
    def cycle(self) -> np.ndarray:
        return self.motion.cycle

    @property
    def mixed(self) -> bool:
        """Whether the simulation's trace mixes commands: then no one shaft is behind it."""
        return self.drive in self.motion.others

    @property
    def mistaken(self) -> np.ndarray:
        """Rows (n,) that are mistaken in themselves, whatever explains the others."""
        return np.zeros(len(self.measured), dtype=bool) if self.lone is None else self.lone

    @property
    def late_last(self) -> "Problem | None":
        """The problem with the simulation's own lag behind the joint; None where it has none."""
        if self.course is None or not self.course.curve:
            return None
        return replace(self, course=self.course.seen_late)

    @property
    def moved_first(self) -> "Problem | None":
        """The problem with what the simulation has before its curve ahead of any term's doing."""
        if self.course is None or not self.course.drive:
            return None
        return replace(self, course=self.course.moved_first)

    @property
    def loaded(self) -> "Problem | None":
        """The problem with the simulation's own lag or creep in the balance; None without."""
        course = None if self.course is None else self.course.under_load
        return None if course is None else replace(self, course=course)

    def trace(self, pieces: Sequence[Piece]) -> Trace:
        """What a mechanism of some pieces does over all rows, without calibration."""
        mechanism = Mechanism(self.curve, pieces, course=self.course)
        if self.averaged is not None:
            return self.averaged.trace(mechanism)
        behind = self.behind(pieces)
        if behind is not None:
            return behind.trace(mechanism)
        if self.motion.corners or any(piece.term.before_curve for piece in pieces):
            return mechanism.trace(self.motion)
        return mechanism.balanced(self.nominal, self.motion)

    @cached_property
    def nominal(self) -> np.ndarray:
        """What the drive asks for where nothing alters it on its way, (n,)."""
        return Mechanism(self.curve, course=self.course).trace(self.motion).asked

    def by_row(self, pieces: Sequence[Piece]) -> bool:
        """Whether the rows alone say what pieces do, without samples behind or between them."""
        alone = self.averaged is None and self.motion.corners is None
        return alone and self.behind(pieces) is None

    def behind(self, pieces: Sequence[Piece]) -> Picked | None:
        """The samples behind the rows that pieces have to answer on, if the rows are too few."""
        if self.picked is None:
            return None
        return self.picked.behind([*pieces, *(self.course.pieces if self.course else ())])

    def rows(self, wanted: np.ndarray) -> "Problem":
        """The same problem on some of its rows (indices)."""
        return replace(
            self,
            motion=self.motion.rows(wanted),
            measured=self.measured[wanted],
            simulated=self.simulated[wanted],
            train=self.train[wanted],
            heldout=self.heldout[wanted],
            lone=None if self.lone is None else self.lone[wanted],
            levels=None if self.levels is None else self.levels.rows(wanted),
            read=None if self.read is None else self.read[wanted],
        )

    def between_levels(self, levels: Levels, expected: np.ndarray, spread: float) -> "Problem":
        """The problem without what readings of expected values (n,) are off by being read.

        spread: of the noise that was read with them [levels' steps].
        """
        off = levels.off_by_reading(expected, self.measured, spread)
        return replace(
            self,
            measured=self.measured - off,
            read=self.measured,
            levels=levels.less_average(spread),
        )

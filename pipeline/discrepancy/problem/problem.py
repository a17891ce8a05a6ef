"""The problem of one measurement: what drove it, what was measured, what may be fitted."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from pipeline.config import DiagnosisConfig, HeldoutConfig, ToleranceConfig
from pipeline.discrepancy.problem.counts import uncounted
from pipeline.discrepancy.problem.course_trial import Course
from pipeline.discrepancy.problem.driven import (
    ITS_COURSE,
    ITS_CURVE,
    ITS_TRACE,
    DiagnosisError,
    driven_by,
)
from pipeline.discrepancy.problem.fitted import LOOSE_GAIN, tolerance_of_fit
from pipeline.discrepancy.problem.holes import unsettled_rows
from pipeline.discrepancy.problem.jumping import between_branches
from pipeline.discrepancy.problem.levels import Levels, levels_read
from pipeline.discrepancy.problem.line import line_in_a_command, own_commands
from pipeline.discrepancy.problem.own_dynamics import beside_curve
from pipeline.discrepancy.problem.rough import unroughened
from pipeline.discrepancy.problem.rows import Averaged, Picked
from pipeline.discrepancy.problem.spacing import spacing_of
from pipeline.discrepancy.problem.stale import NONE_STALE, StaleSamples, hung_samples, stale_samples
from pipeline.errors import refusal
from pipeline.physics.differentiation import Derivatives
from pipeline.physics.kinematics import Curve, straightened
from pipeline.physics.mechanism import Mechanism, OwnCourse, Trace
from pipeline.physics.motion import Motion
from pipeline.physics.own_amount import own_amounts
from pipeline.physics.piece import Piece
from pipeline.physics.term import Surroundings
from pipeline.recording import Recording

HELD_OUT_EVERY = 3
FEWEST_SAMPLES = 40


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
    which samples say again what the one before said. replaced: the simulation as it came, where
    another stands in its place: a line in a command where it does not move, the middle of its two
    branches where it jumps with the direction (`jumping.py`). unsettled: how many measured samples
    come after a hole and don't count, see `holes.py`. own: what was taken off measured and
    simulated, as the simulation does it beside its curve, RMS, see `own_dynamics.py`. course: what
    the simulation surely has beside its curve (a lag, play, ...), see `course.py`. levels: of a
    sensor that reads in such. read: the measurement as it was read, where what readings are off by
    was taken off, see `levels.py`. coursed, traced: the same where the little that the simulation
    does beside its curve is a course of its own, and with its trace as drive. elsewhere: the same
    where the simulation's own friction, which may be at its drive or at its joint, is at the other
    place.
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
    def late_last(self) -> "Problem | None":
        """The problem with the simulation's own lag behind the joint; None where it has none."""
        if self.course is None or not self.course.curve:
            return None
        return replace(self, course=self.course.seen_late)

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


def pose_problem(
    config: DiagnosisConfig,
    recording: Recording,
    measurement: str,
    simulated: np.ndarray,
    taken_as: str = ITS_CURVE,
) -> Problem:
    """What is to be explained: `measurement`, given a simulation of it (n,).

    taken_as: what drives, see `driven_by`. Raises DiagnosisError where there is too little to
    judge.
    """
    came, given = recording.values(measurement), simulated
    stale = stale_samples(came, simulated)
    if not stale.rows.any():
        stale = replace(stale, hung=hung_samples(came, simulated))
    measured = np.where(stale.rows | stale.hung, np.nan, came)
    known = np.isfinite(measured) & np.isfinite(simulated)
    refuse_unknown(measurement, known)
    refuse_still(measurement, measured[known], simulated[known])
    driven = driven_by(recording, measurement, simulated, taken_as)
    unsettled = unsettled_rows(driven.motion.time_s, driven.motion.drive) & known
    measured, known = np.where(unsettled, np.nan, measured), known & ~unsettled
    heldout = held_out_rows(config.heldout, driven.motion, known)
    train = known & ~heldout
    refuse_unfit(config.heldout, measurement, train, known & heldout)
    replaced = other = None
    if driven.course is None and taken_as == ITS_CURVE:
        other = in_place(recording, measurement, simulated, measured, train)
    if other is not None:
        replaced, simulated = simulated, other
        driven = driven_by(recording, measurement, simulated)
    motion, curve, drive, static, course = driven
    counted = rough = own = 0.0
    beside = False
    if course is not None:
        measured = measured - (simulated - course.reproduced)
        simulated = np.where(np.isfinite(simulated), course.reproduced, np.nan)
    elif static:
        found, stays = beside_curve(motion, curve, simulated, np.where(train, measured, np.nan))
        beside = bool(found.any()) and replaced is None
        if stays:
            measured, simulated, own = measured - found, simulated - found, float(np.std(found))
        motion, curve, counted, rough = smoothed(motion, curve, measured, simulated, train)
    around = surroundings_of(recording, measurement, motion, simulated, drive, static, train)
    tolerance = tolerance_of_fit(config.tolerance, came, simulated, motion.drive, heldout)
    if replaced is not None:
        tolerance = replace(tolerance, gain=max(tolerance.gain, LOOSE_GAIN))
    bent = static and tolerance.shape > config.tolerance.shape
    if bent:
        curve = straightened(curve, motion.drive)
    if course is not None:
        around = replace(around, own=own_amounts(course.own.pieces, around))
    posed = Problem(
        motion, curve, measured, simulated, train, known & heldout, around, tolerance,
        drive, static, counted=counted, rough=rough, stale=stale, replaced=replaced,
        unsettled=int(unsettled.sum()), own=own,
        course=None if course is None else course.own,
        levels=levels_read(came, measured),
    )  # fmt: skip
    if beside:
        taken = (ITS_COURSE, ITS_TRACE)
        others = (pose_problem(config, recording, measurement, given, how) for how in taken)
        return with_others(posed, *others)
    if course is None or course.otherwise is None:
        return posed
    return replace(posed, elsewhere=rubbing_elsewhere(posed, course, course.otherwise, bent))


def with_others(posed: Problem, coursed: Problem, traced: Problem) -> Problem:
    """A problem with its simulation taken as a course of its own, if it has one, and as a trace."""
    if coursed.course is None:
        return replace(posed, traced=traced)
    return replace(posed, coursed=replace(coursed, traced=traced), traced=traced)


def rubbing_elsewhere(posed: Problem, course: Course, other: Course, bent: bool) -> Problem:
    """A problem of one course of its simulation, with the other; bent: whether any curve may be."""
    return replace(
        posed,
        curve=straightened(other.curve, posed.motion.drive) if bent else other.curve,
        measured=posed.measured - course.reproduced + other.reproduced,
        simulated=np.where(np.isfinite(posed.simulated), other.reproduced, np.nan),
        course=other.own,
        around=replace(posed.around, own=own_amounts(other.own.pieces, posed.around)),
    )


def smoothed(
    motion: Motion,
    curve: Curve,
    measured: np.ndarray,
    simulated: np.ndarray,
    train: np.ndarray,
) -> tuple[Motion, Curve, float, float]:
    """The motion behind a drive that was counted or measured, its curve, the step, and the noise.

    Arrays are (n,); the measurement says on `train` rows whether that is what moved.
    """
    seen = np.where(train, measured, np.nan)
    motion, curve, counted = uncounted(motion, curve, seen, simulated)
    if counted > 0.0:
        return motion, curve, counted, 0.0
    smooth, rough = unroughened(motion.drive, motion.time_s, seen)
    return replace(motion, drive=smooth), curve, 0.0, rough


def in_place(
    recording: Recording,
    measurement: str,
    simulated: np.ndarray,
    measured: np.ndarray,
    train: np.ndarray,
) -> np.ndarray | None:
    """What stands in the place of a simulation (n,) that does not move, or jumps; None of others.

    measured: (n,), fitted on `train` rows (n,) where it does not move.
    """
    if np.ptp(simulated[np.isfinite(measured) & np.isfinite(simulated)]) > 0.0:
        commands = {c.name: recording.values(c.name) for c in recording.with_role("command")}
        return between_branches(commands, simulated)
    line = line_in_a_command(own_commands(recording, measurement), measured, train)
    return None if line is None else line[0]


def refuse_unfit(
    config: HeldoutConfig, measurement: str, train: np.ndarray, heldout: np.ndarray
) -> None:
    """Raise DiagnosisError where masks (n,) leave too few rows to fit on, or none as a proof."""
    refuse_unknown(measurement, train | heldout)
    if not heldout.any():
        raise DiagnosisError(
            refusal(
                f"measurement {measurement!r}",
                "measured rows that are held out",
                f"none ({config.kind}, after_s={config.after_s})",
                "Hold out other rows: see diagnosis.heldout.",
            )
        )
    if train.sum() < FEWEST_SAMPLES:
        raise DiagnosisError(
            refusal(
                f"measurement {measurement!r}",
                f"at least {FEWEST_SAMPLES} measured samples to fit on",
                f"{int(train.sum())} of {len(train)} rows (held-out cycles are not counted)",
                "Record more cycles or more steps.",
            )
        )


def refuse_unknown(measurement: str, known: np.ndarray) -> None:
    """Raise DiagnosisError where no row (n,) is both measured and simulated."""
    if not known.any():
        raise DiagnosisError(
            refusal(
                f"measurement {measurement!r}",
                "samples that were measured, and simulated",
                f"none in {len(known)} rows",
                "Measure it, or take the channel and its simulation out of recording.json.",
            )
        )


def refuse_still(measurement: str, measured: np.ndarray, simulated: np.ndarray) -> None:
    """Raise DiagnosisError where neither measurement nor simulation, (n,) each, ever moves."""
    if np.ptp(measured) == 0.0 and np.ptp(simulated) == 0.0:
        raise DiagnosisError(
            refusal(
                f"measurement {measurement!r}",
                "samples in which it or its simulation moves",
                f"{measured[0]:g} in all {len(measured)} rows, simulated as {simulated[0]:g}",
                "Record a motion, or check that the sensor was on.",
            )
        )


def held_out_rows(config: HeldoutConfig, motion: Motion, known: np.ndarray) -> np.ndarray:
    """Rows (n,) that are held out, of those that are known (n,).

    Of every third cycle, the last third of the known rows where there are fewer than three cycles,
    or where none or all of those rows were measured; or as the configuration says otherwise.
    """
    cycle = motion.cycle
    if config.kind == "after_s":
        rows: np.ndarray = motion.time_s - motion.time_s[0] > (config.after_s or 0.0)
        return rows
    numbers = np.unique(cycle)
    rows = np.isin(cycle, numbers[HELD_OUT_EVERY - 1 :: HELD_OUT_EVERY])
    few = len(numbers) < HELD_OUT_EVERY or not rows[known].any() or rows[known].all()
    if few or config.kind == "last_third":
        rows = np.zeros(len(cycle), dtype=bool)
        have = np.flatnonzero(known)
        if len(have):
            rows[have[len(have) - max(len(have) // HELD_OUT_EVERY, 1)] :] = True
    return rows


def surroundings_of(
    recording: Recording,
    measurement: str,
    motion: Motion,
    simulated: np.ndarray,
    drive: str,
    static: bool,
    train: np.ndarray,
) -> Surroundings:
    """The sizes that bound the terms' parameters; as measured where the simulation stands still.

    An axis that moved in no row that may be fitted counts as one that never did.
    """
    steps = np.abs(np.diff(motion.drive))
    step = float(np.median(steps[steps > 0])) if np.any(steps > 0) else 0.0
    unit = recording.channel(measurement).unit
    known = simulated[np.isfinite(simulated)]
    span = float(np.ptp(known)) or float(np.ptp(recording.values(measurement)[train]))
    return Surroundings(
        drive_span=float(np.ptp(motion.drive)),
        drive_low=float(np.min(motion.drive)),
        angle_span=max(span, 1e-9),
        angle_low=float(np.min(known)),
        step=step,
        spacing=spacing_of(motion.drive, step),
        dwell_s=float(np.median(np.diff(motion.time_s))),
        start_s=float(motion.time_s[0]),
        end_s=float(motion.time_s[-1]),
        cycles=len(np.unique(motion.cycle)),
        travel=float(steps.sum()),
        drive_unit=recording.channel(drive).unit if static else unit,
        angle_unit=unit,
        other_span={
            n: float(np.ptp(u)) if np.ptp(u[train]) > 0.0 else 0.0 for n, u in motion.others.items()
        },
        other_unit={n: recording.channel(n).unit for n in motion.others},
    )

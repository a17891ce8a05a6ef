"""The problem of an angle posed: what drove it, which rows count, what may be fitted."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from pipeline.config import DiagnosisConfig
from pipeline.discrepancy.problem.counts import uncounted
from pipeline.discrepancy.problem.course_trial import Course
from pipeline.discrepancy.problem.driven import (
    ITS_COURSE,
    ITS_CURVE,
    ITS_TRACE,
    Driven,
    driven_by,
)
from pipeline.discrepancy.problem.fitted import LOOSE_GAIN, tolerance_of_fit
from pipeline.discrepancy.problem.jumping import between_branches
from pipeline.discrepancy.problem.known_rows import fresh_samples, rows_that_count
from pipeline.discrepancy.problem.levels import levels_read
from pipeline.discrepancy.problem.line import line_in_a_command, own_commands
from pipeline.discrepancy.problem.own_dynamics import beside_curve
from pipeline.discrepancy.problem.problem import Problem
from pipeline.discrepancy.problem.rough import unroughened
from pipeline.discrepancy.problem.spacing import spacing_of
from pipeline.physics.kinematics import straightened
from pipeline.physics.own_amount import own_amounts
from pipeline.physics.term import Surroundings
from pipeline.recording import Recording


def pose_problem(
    config: DiagnosisConfig, recording: Recording, measurement: str, simulated: np.ndarray
) -> Problem:
    """What is to be explained: `measurement`, given a simulation of it (n,).

    Raises DiagnosisError where there is too little to judge.
    """
    posed, beside = posed_as(config, recording, measurement, simulated, ITS_CURVE)
    if not beside:
        return posed
    coursed, traced = (
        posed_as(config, recording, measurement, simulated, taken_as)[0]
        for taken_as in (ITS_COURSE, ITS_TRACE)
    )
    return with_others(posed, coursed, traced)


def posed_as(
    config: DiagnosisConfig,
    recording: Recording,
    measurement: str,
    simulated: np.ndarray,
    taken_as: str,
) -> tuple[Problem, bool]:
    """The problem of a simulation (n,) taken as a curve, a course or a trace: see `driven_by`.

    And whether the simulation does a little beside its curve, so that it may be taken otherwise.
    """
    came = recording.values(measurement)
    measured, stale = fresh_samples(measurement, came, simulated)
    driven = driven_by(recording, measurement, simulated, taken_as)
    rows = rows_that_count(config.heldout, measurement, measured, simulated, driven.motion)
    replaced = None
    if driven.course is None and taken_as == ITS_CURVE:
        other = in_place(recording, measurement, simulated, rows.measured, rows.train)
        if other is not None:
            replaced, simulated = simulated, other
            driven = driven_by(recording, measurement, simulated)
    course = driven.course
    left = left_of(driven, rows.measured, simulated, rows.train)
    driven, counted, rough = smoothed(driven, left.measured, left.simulated, rows.train)
    tolerance = tolerance_of_fit(
        config.tolerance, came, left.simulated, driven.motion.drive, rows.withheld
    )
    if replaced is not None:
        tolerance = replace(tolerance, gain=max(tolerance.gain, LOOSE_GAIN))
    bent = driven.static and tolerance.shape > config.tolerance.shape
    around = surroundings_of(recording, measurement, driven, left.simulated, rows.train)
    posed = Problem(
        motion=driven.motion,
        curve=straightened(driven.curve, driven.motion.drive) if bent else driven.curve,
        measured=left.measured,
        simulated=left.simulated,
        train=rows.train,
        heldout=rows.heldout,
        around=around,
        tolerance=tolerance,
        drive=driven.drive,
        static=driven.static,
        counted=counted,
        rough=rough,
        stale=stale,
        replaced=replaced,
        unsettled=rows.unsettled,
        own=left.own,
        course=None if course is None else course.own,
        levels=levels_read(came, left.measured),
    )
    if course is not None and course.otherwise is not None:
        posed = replace(posed, elsewhere=rubbing_elsewhere(posed, course, course.otherwise, bent))
    return posed, left.beside and replaced is None


class Left(NamedTuple):
    """What is left of a measurement and its simulation, (n,) each, without what both do alike.

    own: how much was taken off both, RMS. beside: whether the simulation does a little beside its
    curve.
    """

    measured: np.ndarray
    simulated: np.ndarray
    own: float = 0.0
    beside: bool = False


def left_of(driven: Driven, measured: np.ndarray, simulated: np.ndarray, train: np.ndarray) -> Left:
    """A measurement and its simulation without what is beside the course, or beside the curve.

    Arrays are (n,); the measurement says on `train` rows whether it goes along.
    """
    if driven.course is not None:
        follows = driven.course.reproduced
        known = np.isfinite(simulated)
        return Left(measured - (simulated - follows), np.where(known, follows, np.nan))
    if not driven.static:
        return Left(measured, simulated)
    seen = np.where(train, measured, np.nan)
    found, stays = beside_curve(driven.motion, driven.curve, simulated, seen)
    if not stays:
        return Left(measured, simulated, beside=bool(found.any()))
    return Left(measured - found, simulated - found, float(np.std(found)), bool(found.any()))


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
    driven: Driven, measured: np.ndarray, simulated: np.ndarray, train: np.ndarray
) -> tuple[Driven, float, float]:
    """The motion behind a drive that was counted or measured, its curve, the step, and the noise.

    Arrays are (n,); the measurement says on `train` rows whether that is what moved.
    """
    if driven.course is not None or not driven.static:
        return driven, 0.0, 0.0
    seen = np.where(train, measured, np.nan)
    motion, curve, counted = uncounted(driven.motion, driven.curve, seen, simulated)
    if counted > 0.0:
        return driven._replace(motion=motion, curve=curve), counted, 0.0
    smooth, rough = unroughened(motion.drive, motion.time_s, seen)
    return driven._replace(motion=replace(motion, drive=smooth), curve=curve), 0.0, rough


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


def surroundings_of(
    recording: Recording,
    measurement: str,
    driven: Driven,
    simulated: np.ndarray,
    train: np.ndarray,
) -> Surroundings:
    """The sizes that bound the terms' parameters; as measured where the simulation stands still.

    An axis that moved in no row that may be fitted counts as one that never did.
    """
    motion = driven.motion
    steps = np.abs(np.diff(motion.drive))
    step = float(np.median(steps[steps > 0])) if np.any(steps > 0) else 0.0
    unit = recording.channel(measurement).unit
    known = simulated[np.isfinite(simulated)]
    span = float(np.ptp(known)) or float(np.ptp(recording.values(measurement)[train]))
    around = Surroundings(
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
        drive_unit=recording.channel(driven.drive).unit if driven.static else unit,
        angle_unit=unit,
        other_span={
            n: float(np.ptp(u)) if np.ptp(u[train]) > 0.0 else 0.0 for n, u in motion.others.items()
        },
        other_unit={n: recording.channel(n).unit for n in motion.others},
    )
    if driven.course is None:
        return around
    return replace(around, own=own_amounts(driven.course.own.pieces, around))

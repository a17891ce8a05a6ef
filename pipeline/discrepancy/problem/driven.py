"""What drives a simulation: a command through a curve, or the simulation's own trace."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from pipeline.discrepancy.problem.cornered import moved_on
from pipeline.discrepancy.problem.course import course_of
from pipeline.discrepancy.problem.course_trial import Course
from pipeline.discrepancy.problem.static_misfit import static_misfit
from pipeline.errors import LoopgapError, refusal
from pipeline.physics.force_units import radian_in
from pipeline.physics.kinematics import Curve, IdentityCurve, sampled_curve
from pipeline.physics.motion import Motion, zero_of
from pipeline.recording import Recording

STATIC_ERROR = 2e-3
MIXED = 0.05
ITS_CURVE, ITS_COURSE, ITS_TRACE = "curve", "course", "trace"


class DiagnosisError(LoopgapError):
    """A recording can't be diagnosed."""


class Driven(NamedTuple):
    """The motion, the nominal curve and the driving command's name; static: whether there is one.

    course: what the simulation has beside its curve (a lag, play, ...), None for nothing known.
    """

    motion: Motion
    curve: Curve
    drive: str
    static: bool
    course: Course | None


def driven_by(
    recording: Recording, measurement: str, simulated: np.ndarray, taken_as: str = ITS_CURVE
) -> Driven:
    """What drives a simulation (n,) of a measurement.

    Where the simulation is a static curve of a command, or that with a lag, creep, friction or play
    of its own, that command drives and the curve is learnt from the two. Otherwise the simulation's
    trace drives, and no curve follows; so it does if it is taken as ITS_TRACE. Taken as ITS_COURSE,
    a little beside a curve is a lag, creep, friction or play, too. Where a trace mixes several
    commands, each of them is one of the others too. Raises DiagnosisError where nothing was
    commanded.
    """
    commands = {c.name: recording.values(c.name) for c in recording.with_role("command")}
    if not commands:
        raise DiagnosisError(
            refusal("recording", "a channel of role 'command'", "none", "Add what was commanded.")
        )
    known = np.isfinite(simulated)
    misfit = {n: static_misfit(u[known], simulated[known]) for n, u in commands.items()}
    drive = min(commands, key=lambda n: (misfit[n] >= STATIC_ERROR, not _kin(n, measurement),
                                         misfit[n]))  # fmt: skip
    static = misfit[drive] < STATIC_ERROR and taken_as == ITS_CURVE
    own_first = {n: commands[n] for n in sorted(commands, key=lambda n: not _kin(n, measurement))}
    course = None
    if not static and taken_as != ITS_TRACE:
        course = course_of(own_first, recording.values("time_s"), simulated)
    if course is not None:
        drive, static = course.command, True
    signal: np.ndarray = commands[drive]
    curve: Curve = IdentityCurve()
    if course is not None:
        curve = course.curve
    elif static:
        curve = sampled_curve(signal[known], simulated[known])
    else:
        rows = np.arange(len(simulated))
        signal = np.interp(rows, rows[known], simulated[known])
    mixed = not static and mixes(commands, drive, simulated)
    others = {n: u for n, u in commands.items() if n != drive or mixed}
    unit = recording.channel(measurement).unit
    motion = Motion(
        drive=np.ascontiguousarray(signal, dtype=float),
        time_s=recording.values("time_s"),
        cycle=recording.values("cycle").astype(np.int64),
        others=others,
        radian=radian_in(unit, float(np.ptp(simulated[known])) if known.any() else 0.0),
        zeros={n: zero_of(u) for n, u in others.items()},
    )
    if course is not None and course.cornered:
        motion = moved_on(motion)
    return Driven(motion, curve, drive, static, course)


def mixes(commands: Mapping[str, np.ndarray], drive: str, simulated: np.ndarray) -> bool:
    """Whether a simulation moves with other commands about as well as with the driving one.

    It does where a line in all commands leaves less than half of what a line in the driving one
    leaves, and that is more than MIXED of the simulation's variance.
    """
    known = np.isfinite(simulated)
    moving = {n: u[known] for n, u in commands.items() if np.ptp(u[known]) > 0.0}
    if len(moving) < 2:
        return False
    target = simulated[known] - simulated[known].mean()
    left = []
    for names in ([drive], list(moving)):
        columns = np.column_stack([moving[n] - moving[n].mean() for n in names if n in moving])
        weights = np.linalg.lstsq(columns, target, rcond=None)[0] if columns.size else []
        rest = target - columns @ weights if columns.size else target
        left.append(float(rest @ rest) / max(float(target @ target), 1e-300))
    return left[0] > MIXED and left[1] < 0.5 * left[0]


def _kin(command: str, measurement: str) -> bool:
    return command.split("_")[0] == measurement.split("_")[0]

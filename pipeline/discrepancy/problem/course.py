"""A simulation's own course: a curve of a command that comes late, creeps, rubs or has play.

Friction may be at the drive or at the joint. Of the latter the joint's angles say what it holds
back, and so what the curve has to ask for.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from pipeline.discrepancy.problem.cornered import moved_on
from pipeline.discrepancy.problem.course_pairs import pairs
from pipeline.discrepancy.problem.course_pieces import single
from pipeline.discrepancy.problem.course_trial import DEGREE, NOTHING, Course, Trial, rubs
from pipeline.physics.mechanism import OwnCourse
from pipeline.physics.motion import Motion

EXACT, ROUGHLY, BETTER, PLAINER, ALIKE, OF_LOOP = 2e-3, 4e-3, 0.1, 2.0, 2e-4, 0.01
ENOUGH, NEAR, MUCH_BETTER, MIXED = 1e-3, 0.05, 3.0, 0.7
MOST_ROWS = 20_000

Found = tuple[float, OwnCourse]


def course_of(
    commands: Mapping[str, np.ndarray], time_s: np.ndarray, simulated: np.ndarray
) -> Course | None:
    """The course of a simulation (n,), where one makes it of a command (n,) to EXACT of its range.

    Friction, of which each simulation has a law of its own, ROUGHLY so. It must leave less than a
    tenth of what a curve alone leaves; of those that leave about as little the plainest counts. The
    command may have turned between samples, where the simulation says so (`corners.py`).
    """
    known = np.flatnonzero(np.isfinite(simulated))[:MOST_ROWS]
    span = float(np.ptp(simulated[known])) if len(known) else 0.0
    for name, command in commands.items():
        if span == 0.0 or np.ptp(command[known]) == 0.0 or known[-1] + 1 < DEGREE * DEGREE:
            continue
        others = {n: other for n, other in commands.items() if n != name}
        motion = Motion(command, time_s, np.zeros(len(command), dtype=np.int64), others)
        course = course_on(name, motion, simulated, known)
        cornered = moved_on(motion)
        if cornered.corners is not None:
            other = course_on(name, cornered, simulated, known)
            if other is not None and (course is None or nearer(other, course, simulated, known)):
                course = replace(other, cornered=True)
        if course is not None:
            return course
    return None


def course_on(name: str, motion: Motion, simulated: np.ndarray, known: np.ndarray) -> Course | None:
    """The course of a simulation (n,) of which some rows are known, of a motion's drive."""
    whole, rows = motion.whole
    span, known_s = float(np.ptp(simulated[known])), motion.time_s[known]
    trial = Trial(
        whole.drive, whole.time_s, np.interp(whole.time_s, known_s, simulated[known]), rows[known]
    )
    others = [other[trial.until] for other in whole.others.values()]
    found = suiting(trial, span, trial.left_by_mix(others))
    if not found:
        return None
    alike = min(ALIKE * span, OF_LOOP * trial.left(NOTHING))
    enough = max(PLAINER * min(left for left, _ in found), alike)
    own = next(own for left, own in found if left <= enough)
    if rubs(own):
        own = rubbing_one(found)
    course, other = trial.course(name, own, rows), elsewhere(own, found)
    return course if other is None else replace(course, otherwise=trial.course(name, other, rows))


def nearer(one: Course, other: Course, simulated: np.ndarray, known: np.ndarray) -> bool:
    """Whether a course is clearly nearer to a simulation (n,) in the rows known than another."""
    off, by_other = ((c.reproduced - simulated)[known] for c in (one, other))
    return bool(np.std(off) < np.std(by_other) / MUCH_BETTER)


def suiting(trial: Trial, span: float, mixed: float) -> list[Found]:
    """The courses that suit a simulation of that range, with what each leaves, the plainest first.

    Of two pieces where one leaves more than ENOUGH and two leave MUCH_BETTER, or none suits. Not of
    one loop, gone through again and again: two can make any of it; nor where a mix of commands
    leaves so much less (`mixed`, RMS) that several move it.
    """
    static = trial.left(NOTHING)
    alone, several = BETTER * static, mixed < MIXED * static

    def suits(one: Found) -> bool:
        left, own = one
        return left < min(limit_of(own) * span, alone)

    tried = measured(trial, single(trial))
    found, least = [one for one in tried if suits(one)], min(left for left, _ in tried)
    unsure = ENOUGH * span < least < NEAR * span
    if unsure and not several and trial.loop_misfit > ENOUGH:
        both = [one for one in measured(trial, pairs(trial.thinned)) if suits(one)]
        both = [(left, own) for left, own in both if trial.off(own) < limit_of(own) * span]
        if both and (not found or min(left for left, _ in both) < least / MUCH_BETTER):
            return both
    return found


def measured(trial: Trial, courses: Iterable[OwnCourse]) -> list[Found]:
    """Courses with what each leaves (RMS)."""
    return [(trial.left(own), own) for own in courses]


def rubbing_one(found: Sequence[Found]) -> OwnCourse:
    """Of the courses found, with what each leaves, the first friction that leaves about least."""
    ones = [(left, own) for left, own in found if rubs(own)]
    least = min(left for left, _ in ones)
    return next(own for left, own in ones if left <= PLAINER * least)


def elsewhere(own: OwnCourse, found: Sequence[Found]) -> OwnCourse | None:
    """Of the courses found, with what each leaves, the best friction at the other place."""
    others = [
        one for one in found if rubs(own) and rubs(one[1]) and bool(one[1].joint) != bool(own.joint)
    ]
    return min(others, key=lambda one: one[0])[1] if others else None


def limit_of(own: OwnCourse) -> float:
    """How much of a simulation's range a course may leave to be its own."""
    return ROUGHLY if rubs(own) else EXACT

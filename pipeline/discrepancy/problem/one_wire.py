"""A joint that two wires hold in the simulation and one in the robot: its loads move it farther.

A load moves a joint by its force over the stiffness of the wires that hold it. Two wires that are
drawn tight hold it together; where they hang slack, or are soft without a pull, one does at a time,
and that may be a softer one.
"""

from dataclasses import replace

from pipeline.discrepancy.problem.problem import Problem
from pipeline.physics.compliance import Compliance
from pipeline.physics.mechanism import OwnCourse
from pipeline.physics.own_amount import times
from pipeline.physics.slack import Slack

LOOSENING = frozenset({Slack.name, Compliance.name})
TIMES_AS_FAR = 2.0, 3.0, 4.5  # by a wire that is as stiff as simulated, and by softer ones


def held_by_one_wire(problem: Problem) -> list[Problem]:
    """The problem, however its simulation is taken apart, with its own loads TIMES_AS_FAR."""
    ways = (problem, problem.elsewhere, problem.loaded)
    loaded = [way for way in ways if way is not None and loads(way)]
    return [moved_farther(way, farther) for way in loaded for farther in TIMES_AS_FAR]


def loads(problem: Problem) -> bool:
    """Whether the simulation has a load of its own at the joint, where its own wires hold that."""
    return problem.course is not None and bool(problem.course.joint) and not held_by_one(problem)


def held_by_one(problem: Problem) -> bool:
    """Whether a problem is of a joint that one wire holds, and two in its simulation."""
    return problem.course is not None and problem.course.farther != 1.0


def moved_farther(problem: Problem, farther: float) -> Problem:
    """The problem with what loads the joint in the simulation moving it that many times as far.

    No term says then how much more or less of it there is.
    """
    assert problem.course is not None
    gone = {piece.term.name for piece in problem.course.joint}
    own = {name: amount for name, amount in problem.around.own.items() if name not in gone}
    around = replace(problem.around, own=own)
    return replace(problem, course=loaded_by(problem.course, farther), around=around)


def loaded_by(course: OwnCourse, factor: float) -> OwnCourse:
    """A course with that many times its loads at the joint."""
    joint = tuple(times(piece, factor, as_stiff=False) for piece in course.joint)
    return replace(course, joint=joint, farther=factor * course.farther)

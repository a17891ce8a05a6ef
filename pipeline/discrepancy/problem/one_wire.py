"""A joint that two wires hold in the simulation and one in the robot: its loads count twice there.

A load moves a joint by its force over the stiffness of the wires that hold it. Two wires that are
drawn tight hold it together; where they hang slack, or are soft without a pull, one does at a time.
"""

from dataclasses import replace

from pipeline.discrepancy.problem.problem import Problem
from pipeline.physics.compliance import Compliance
from pipeline.physics.mechanism import OwnCourse
from pipeline.physics.own_amount import times
from pipeline.physics.slack import Slack

LOOSENING = frozenset({Slack.name, Compliance.name})
WIRES = 2.0


def on_one_wire(problem: Problem) -> list[Problem]:
    """The problem, however its simulation is taken apart, with twice its own loads at the joint."""
    ways = (problem, problem.elsewhere, problem.loaded)
    return [twice_loaded(way) for way in ways if way is not None and loads(way)]


def loads(problem: Problem) -> bool:
    """Whether the simulation has a load of its own at the joint, as its own amounts say it."""
    joint = () if problem.course is None else problem.course.joint
    return any(piece.term.name in problem.around.own for piece in joint)


def twice_loaded(problem: Problem) -> Problem:
    """The problem with twice the simulation's own loads; no term says how much more or less."""
    assert problem.course is not None
    gone = {piece.term.name for piece in problem.course.joint}
    own = {name: amount for name, amount in problem.around.own.items() if name not in gone}
    around = replace(problem.around, own=own)
    return replace(problem, course=loaded_by(problem.course, WIRES), around=around)


def loaded_by(course: OwnCourse, factor: float) -> OwnCourse:
    """A course with that many times its loads at the joint."""
    joint = tuple(times(piece, factor, as_stiff=False) for piece in course.joint)
    return replace(course, joint=joint)


def held_by_one(problem: Problem) -> bool:
    """Whether a problem is of a joint that one wire holds, and two in its simulation."""
    joint = () if problem.course is None else problem.course.joint
    return bool(joint) and not loads(problem)

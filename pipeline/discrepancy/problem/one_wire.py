"""A joint that two wires hold in the simulation and one in the robot: its loads count twice there.

A load moves a joint by its force over the stiffness of the wires that hold it. Two wires that are
drawn tight hold it together; where they hang slack, or are soft without a pull, one does at a time.
"""

from dataclasses import replace

from pipeline.discrepancy.problem.problem import Problem
from pipeline.physics.compliance import Compliance
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
    """The problem with twice the simulation's own loads: no term says then by how much they differ.

    Of what has no load there, as much as before.
    """
    assert problem.course is not None
    joint = problem.course.joint
    doubled = tuple(times(piece, WIRES, as_stiff=False) for piece in joint)
    own = {k: v for k, v in problem.around.own.items() if k not in {p.term.name for p in joint}}
    return replace(
        problem,
        course=replace(problem.course, joint=doubled),
        around=replace(problem.around, own=own),
    )


def held_by_one(problem: Problem) -> bool:
    """Whether a problem is of a joint that one wire holds, and two in its simulation."""
    joint = () if problem.course is None else problem.course.joint
    return bool(joint) and not any(piece.term.name in problem.around.own for piece in joint)

"""The paper's Algorithm 1 put right: commands that bring the robot to desired angles.

For each desired angle: the direction of travel is the sign of the desired change, held where there
is none; the command is sought on the rising branch of that direction, between its bounds, from the
command before. A bracket keeps every step rule between the commands that are known to be too low
and too high; a proposal outside it is replaced by the bracket's middle.

The branches are those of full loops. Right after a reversal half way the true robot is on an inner
loop: there the commands are as good as the inner loop's return to the full one is quick.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from pipeline.config import CompensationConfig
from pipeline.control.monotone import MonotoneBranch, monotone_branch
from pipeline.control.step_rules import Point, StepRule, step_rule
from pipeline.errors import LoopgapError, refusal
from pipeline.models.loop_model import LoopModel

CONVERGED = "converged"
CLIPPED = "clipped"
UNREACHABLE = "unreachable"
MAX_ITERATIONS = "max_iterations"


@dataclass(frozen=True)
class Solution:
    """The command for one desired angle, and how its search ended.

    converged: the model's angle is within the tolerance of the target. clipped: the target is
    beyond this branch, though the other direction's branch reaches it; the command stands at its
    bound. unreachable: no command within the bounds gives this angle in either direction; the
    command stands at its bound. max_iterations: the step rule was too slow; the best command found.
    """

    target_deg: float
    command_deg: float
    model_deg: float
    direction: int
    status: str
    iterations: int


@dataclass(frozen=True)
class State:
    """Where a path starts: the command and desired angle before it, and the direction (0: none)."""

    command_deg: float = 0.0
    target_deg: float = 0.0
    direction: int = 0


HOME = State()


Branches = Mapping[int, MonotoneBranch]


def loop_branches(model: LoopModel) -> Branches:
    """The rising branches of a loop model, by direction of travel (+1, -1)."""
    return {1: monotone_branch(model.cw), -1: monotone_branch(model.ccw)}


def nominal_branches(model: LoopModel) -> Branches:
    """The nominal model's one curve for both directions: an inverse that knows no hysteresis."""
    branch = monotone_branch(model.nominal)
    return {1: branch, -1: branch}


def directions_of(targets_deg: Sequence[float], state: State) -> list[int]:
    """Direction of travel of each target: the sign of the desired change, held where it is none.

    Before the first change it is the state's direction, or else that of the first change; a path
    without any counts as ascending.
    """
    changes = np.diff(np.asarray(targets_deg, dtype=float), prepend=state.target_deg)
    signs = [int(sign) for sign in np.sign(changes)]
    current = state.direction or next((sign for sign in signs if sign), 1)
    directions = []
    for sign in signs:
        current = sign or current
        directions.append(current)
    return directions


def follow(
    branches: Branches,
    targets_deg: Sequence[float],
    config: CompensationConfig,
    state: State = HOME,
) -> list[Solution]:
    """Commands for a path of desired angles [deg]; each search starts where the last one ended.

    LoopgapError if a target is no number.
    """
    _check_targets(targets_deg)
    solutions: list[Solution] = []
    command = state.command_deg
    for target, direction in zip(targets_deg, directions_of(targets_deg, state), strict=True):
        solution = invert(branches, float(target), direction, command, config)
        solutions.append(solution)
        command = solution.command_deg
    return solutions


def invert(
    branches: Branches,
    target_deg: float,
    direction: int,
    start_deg: float,
    config: CompensationConfig,
) -> Solution:
    """The command [deg of shaft] at which the branch of a direction has the desired angle [deg].

    direction: +1 ascending, -1 descending. start_deg: the command to search from. The solution's
    status says where there is none (clipped, unreachable) or none was found; nothing is raised.
    """
    branch = branches[direction]
    beyond = _beyond_reach(branches, target_deg, direction)
    if beyond is not None:
        return beyond
    rule = step_rule(config.step_rule)
    low, high = branch.bounds_deg
    here = _point(branch, target_deg, min(max(start_deg, low), high))
    best, iterations = here, 0
    while abs(here.error_deg) > config.tolerance_deg and iterations < config.max_iterations:
        if here.error_deg > 0.0:
            high = here.command_deg
        else:
            low = here.command_deg
        here = _point(branch, target_deg, _next(branch, target_deg, rule, here, low, high))
        iterations += 1
        if abs(here.error_deg) <= abs(best.error_deg):
            best = here
    status = CONVERGED if abs(best.error_deg) <= config.tolerance_deg else MAX_ITERATIONS
    angle = target_deg + best.error_deg
    return Solution(target_deg, best.command_deg, angle, direction, status, iterations)


def _check_targets(targets_deg: Sequence[float]) -> None:
    bad = np.flatnonzero(~np.isfinite(np.asarray(targets_deg, dtype=float)))
    if bad.size:
        raise LoopgapError(
            refusal(
                f"target {int(bad[0])}",
                "an angle in degrees",
                f"{targets_deg[bad[0]]}",
                "Take it out of the path, or fill it in.",
            )
        )


def _next(
    branch: MonotoneBranch, target_deg: float, rule: StepRule, here: Point, low: float, high: float
) -> float:
    """The rule's proposal, or the bracket's middle where that lies outside the bracket."""

    def point_at(command_deg: float) -> Point:
        return _point(branch, target_deg, min(max(command_deg, low), high))

    proposal = rule.propose(here, point_at)
    return proposal if low <= proposal <= high else 0.5 * (low + high)


def _point(branch: MonotoneBranch, target_deg: float, command_deg: float) -> Point:
    angle, slope = branch.at(command_deg)
    return Point(command_deg, angle - target_deg, slope)


def _beyond_reach(branches: Branches, target_deg: float, direction: int) -> Solution | None:
    """The answer for a target beyond the branch's ends, None if it lies between them."""
    branch = branches[direction]
    lowest, highest = branch.reach_deg
    if lowest <= target_deg <= highest:
        return None
    end = 0 if target_deg < lowest else 1
    reach = [other.reach_deg for other in branches.values()]
    within = min(r[0] for r in reach) <= target_deg <= max(r[1] for r in reach)
    status = CLIPPED if within else UNREACHABLE
    command, angle = branch.bounds_deg[end], branch.reach_deg[end]
    return Solution(target_deg, command, angle, direction, status, 0)

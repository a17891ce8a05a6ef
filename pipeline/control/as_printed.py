"""The paper's Algorithm 1 as it is printed, and the ways in which it can be read.

It is here to show what it does, not to be used. The branch is chosen by comparing the search's
command q with an earlier one, q_prev: ascending when q > q_prev, descending when q < q_prev; the
step is Armijo's (or another rule's) on the mixture's own mean, which need not rise.

as_printed           q_prev starts at q and is set to each new q: neither case ever holds, so no
                     branch is chosen and the command never moves.
ascending_or_equal   the same with q >= q_prev: the descending branch is never chosen.
previous_iterate     q_prev is the iterate before: the branch flips within a search.
previous_command     q_prev is the command of the target before: angles come out right, though the
                     shaft is driven back and forth to get there.
"""

from collections.abc import Sequence

import numpy as np

from pipeline.config import CompensationConfig
from pipeline.control.inverse import CONVERGED, HOME, MAX_ITERATIONS, Solution, State
from pipeline.control.step_rules import Point, step_rule
from pipeline.errors import UsageError, refusal
from pipeline.models.loop_model import LoopModel

NO_BRANCH = "no_branch"
READINGS = ("as_printed", "ascending_or_equal", "previous_iterate", "previous_command")


def follow_as_printed(
    model: LoopModel,
    targets_deg: Sequence[float],
    config: CompensationConfig,
    state: State = HOME,
) -> list[Solution]:
    """Commands for a path of desired angles [deg] by the reading `config.algorithm`.

    Statuses: converged, max_iterations, and no_branch where the algorithm chooses none.
    """
    if config.algorithm not in READINGS:
        raise UsageError(
            refusal(
                "compensation.algorithm",
                f"one of {', '.join(('corrected', *READINGS))}",
                repr(config.algorithm),
                "Choose one of them.",
            )
        )
    command = state.command_deg
    solutions: list[Solution] = []
    for target in targets_deg:
        solution = _search(model, float(target), command, config)
        solutions.append(solution)
        command = solution.command_deg
    return solutions


def _search(
    model: LoopModel, target_deg: float, start_deg: float, config: CompensationConfig
) -> Solution:
    rule = step_rule(config.step_rule)
    command = previous = start_deg
    iterations = 0
    while True:
        direction = _direction(command, previous, config.algorithm)
        here = _point(model, target_deg, command, direction)
        if direction == 0:
            status = NO_BRANCH
            break
        if abs(here.error_deg) <= config.tolerance_deg:
            status = CONVERGED
            break
        if iterations == config.max_iterations:
            status = MAX_ITERATIONS
            break

        def point_at(q: float, direction: int = direction) -> Point:
            return _point(model, target_deg, q, direction)

        proposal = rule.propose(here, point_at)
        if config.algorithm == "previous_iterate":
            previous = command
        elif config.algorithm != "previous_command":
            previous = proposal
        command, iterations = proposal, iterations + 1
    angle = target_deg + here.error_deg
    return Solution(target_deg, command, angle, direction, status, iterations)


def _direction(command_deg: float, previous_deg: float, reading: str) -> int:
    if command_deg < previous_deg:
        return -1
    if command_deg > previous_deg or reading != "as_printed":
        return 1
    return 0


def _point(model: LoopModel, target_deg: float, command_deg: float, direction: int) -> Point:
    mixture = {1: model.cw, -1: model.ccw, 0: model.nominal}[direction]
    at = np.array([command_deg])
    error = float(mixture.predict(at)[0][0]) - target_deg
    return Point(command_deg, error, float(mixture.slope(at)[0]))

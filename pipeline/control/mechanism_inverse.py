"""Commands that bring a mechanism with memory to desired angles.

A mechanism answers a command by what it is and by where it has been. So the path is walked target
by target: the state that the last command left is carried on, and the next command is sought with
it. Going on in the direction of the desired change keeps the answer unique where the mechanism has
play: the command that has just taken up the slack, not one within it.
"""

from collections.abc import Callable, Sequence

import numpy as np
from scipy.optimize import brentq

from pipeline.control.inverse import CONVERGED, HOME, MAX_ITERATIONS, UNREACHABLE, Solution
from pipeline.physics.mechanism import Mechanism, State
from pipeline.physics.motion import Motion

MOST_ITERATIONS = 100
COMMAND_TOLERANCE_DEG = 1e-9


def follow_mechanism(
    mechanism: Mechanism,
    targets_deg: Sequence[float],
    bounds_deg: tuple[float, float],
    tolerance_deg: float,
    interval_s: float,
    lead_in_deg: Sequence[float] = (),
) -> list[Solution]:
    """Commands for a path of desired angles [deg], one every `interval_s`, within the bounds.

    lead_in_deg: commands that the mechanism has followed before, from rest at home; other axes
    stand at 0. A target beyond the bounds is `unreachable` and the command stands there; one that
    the response jumps over is `max_iterations`.
    """
    walk = _Walk(mechanism, interval_s)
    for command in (HOME.command_deg, *lead_in_deg):
        walk.go(command)
    solutions: list[Solution] = []
    low, high = bounds_deg
    command = float(lead_in_deg[-1]) if len(lead_in_deg) else HOME.command_deg
    for target in targets_deg:
        here = walk.angle_at(command)
        direction = int(np.sign(target - here)) or (solutions[-1].direction if solutions else 1)
        end = high if direction > 0 else low
        command, status, count = _seek(walk.angle_at, float(target), command, end, tolerance_deg)
        angle = walk.go(command)
        solutions.append(Solution(float(target), command, angle, direction, status, count))
    return solutions


class _Walk:
    """A mechanism on its way: where it has been is its state."""

    def __init__(self, mechanism: Mechanism, interval_s: float) -> None:
        self._mechanism = mechanism
        self._interval_s = interval_s
        self._state: State | None = None
        self._time_s = 0.0

    def angle_at(self, command_deg: float) -> float:
        """The angle if the next command were this one; nothing moves."""
        return self._respond(command_deg)[0]

    def go(self, command_deg: float) -> float:
        """Send the command; the angle that it leads to."""
        angle, self._state = self._respond(command_deg)
        self._time_s += self._interval_s
        return angle

    def _respond(self, command_deg: float) -> tuple[float, State]:
        motion = Motion(
            drive=np.array([command_deg]),
            time_s=np.array([self._time_s + self._interval_s]),
            cycle=np.array([0]),
        )
        angle, state = self._mechanism.respond(motion, self._state)
        return float(angle[0]), state


def _seek(
    angle_at: Callable[[float], float],
    target_deg: float,
    start_deg: float,
    end_deg: float,
    tolerance_deg: float,
) -> tuple[float, str, int]:
    """Command between start and end at which the angle is the target, how it ended, iterations."""
    if abs(angle_at(start_deg) - target_deg) <= tolerance_deg:
        return start_deg, CONVERGED, 0
    if (angle_at(end_deg) - target_deg) * (angle_at(start_deg) - target_deg) > 0.0:
        return end_deg, UNREACHABLE, 0
    command, report = brentq(
        lambda c: angle_at(c) - target_deg,
        start_deg,
        end_deg,
        xtol=COMMAND_TOLERANCE_DEG,
        maxiter=MOST_ITERATIONS,
        full_output=True,
        disp=False,
    )
    reached = abs(angle_at(command) - target_deg) <= tolerance_deg
    return float(command), CONVERGED if reached else MAX_ITERATIONS, int(report.iterations)

"""A motor that is late and has a top speed."""

import numpy as np

from pipeline.physics.held import STEP_AND_WAIT_S, followed, lag_parameter, usual_lags_s
from pipeline.physics.limited_motor import LimitedMotor
from pipeline.physics.motion import Motion
from pipeline.physics.term import Parameter, Surroundings

SPEEDS = 8
JUMP, RARE = 0.05, 0.2
NO_FASTER = "a top speed, which no lag has: what is slower arrives in time"


class SlewingMotor(LimitedMotor):
    """x' = (u - x) / tau, |x'| <= top_speed, before gears and wires, u held through each dwell.

    One that has a top speed alone is `response_lag/top speed`. Exact, however unevenly sampled.
    Source: first-order lag; a rate limiter.
    """

    form = "slewing"
    beyond_lone = NO_FASTER
    says = (
        "The motor comes late, with a time constant of {time_constant}, and is never faster than "
        "{top_speed}."
    )

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        return lag_parameter(around), speed_parameter(around)

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        return followed(signal, motion, float(values[0]), float(values[1]), state)

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        speeds = fastest(around) * np.geomspace(2e-3, 0.25, SPEEDS)
        return np.array([[lag, speed] for lag in usual_lags_s(around)[::2] for speed in speeds])

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        """Where a drive is sampled too often to step and wait, or jumps now and then."""
        jumps = float(np.mean(np.abs(np.diff(motion.drive)) > JUMP * around.drive_span))
        shows = 0.0 < jumps < RARE or around.dwell_s < STEP_AND_WAIT_S
        return around.drive_span > 0.0 and around.dwell_s > 0.0 and shows


def fastest(around: Surroundings) -> float:
    """Twice the drive's range within one dwell [drive unit/s]: as good as no top speed."""
    return 2.0 * max(around.drive_span, 1e-12) / max(around.dwell_s, 1e-9)


def speed_parameter(around: Surroundings) -> Parameter:
    """A top speed [drive unit/s]."""
    most, unit = fastest(around), f"{around.drive_unit}/s"
    return Parameter("top_speed", unit, 1e-4 * most, most, 1e-2 * most, 0.0, relative=True)


def speeds_of_steps(motion: Motion) -> np.ndarray:
    """How fast the drive goes at each step that moves it, (k,) [drive unit/s]; (0.0,) for none."""
    steps, taken_s = np.abs(np.diff(motion.drive)), np.diff(motion.time_s)
    moves = (steps > 0.0) & (taken_s > 0.0)
    return steps[moves] / taken_s[moves] if np.any(moves) else np.zeros(1)

"""A motor that has a top speed: at the larger steps of a robot that steps and waits it is late."""

import numpy as np

from pipeline.physics.held import STEP_AND_WAIT_S, followed
from pipeline.physics.limited_motor import LimitedMotor
from pipeline.physics.motion import Motion
from pipeline.physics.slewing_motor import NO_FASTER, speed_parameter, speeds_of_steps
from pipeline.physics.term import Parameter, Surroundings

SOME, SLOWER, FARTHER = (0.3, 0.5, 0.7, 0.85, 0.95), 0.97, 1.2


class TopSpeed(LimitedMotor):
    """|x'| <= top_speed, else x = u, of a command u that is held through each dwell.

    Before gears and wires. One that is late besides is `response_lag/slewing`. Source: a rate
    limiter.
    """

    beyond_lone = NO_FASTER
    form = "top speed"
    says = "The motor is never faster than {top_speed}: at larger steps it does not arrive."

    @property
    def kin(self) -> str:
        return "first"

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        return (speed_parameter(around),)

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        return followed(signal, motion, 0.0, float(values[0]), state)

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        return SLOWER * np.unique(np.quantile(speeds_of_steps(motion), SOME))[:, None]

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        """Where a robot that steps and waits goes faster at some of its steps than at others."""
        usual, most = np.quantile(speeds_of_steps(motion), (0.5, 1.0))
        waits = around.drive_span > 0.0 and around.dwell_s >= STEP_AND_WAIT_S
        return waits and bool(most > FARTHER * usual)

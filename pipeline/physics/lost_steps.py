"""Lost steps: the shaft slips at a moment, a jump of the zero."""

import numpy as np

from pipeline.physics.motion import Motion
from pipeline.physics.term import NO_STATE, Parameter, Surroundings, Term

MOMENTS = 150


class LostSteps(Term):
    """x(t) = u(t) + jump * [t >= time]; jump [drive unit], time [s].

    The motor's count no longer belongs to the shaft's angle: a stepper that loses steps, a coupling
    or a set screw that slips. Source: definition.
    """

    name = "lost_steps"
    site = "actuator"
    before_curve = True
    says = "The shaft slipped by {jump} at {time}, and its zero has been off since."

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        span = around.drive_span
        return (
            Parameter("jump", around.drive_unit, -span, span, 0.03 * span, 0.03 * span),
            Parameter("time", "s", around.start_s, around.end_s, around.start_s, 0.0, True),
        )

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        return signal + values[0] * (motion.time_s >= values[1]), NO_STATE

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        rows = np.unique(np.linspace(4, len(motion) - 5, MOMENTS).astype(int))
        jump = np.full(len(rows), 0.01 * around.drive_span)
        return np.column_stack([jump, motion.time_s[rows] - 1e-6])

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        return len(motion) > 20

"""Slack: a dead zone around home, without a loop."""

import numpy as np

from pipeline.physics.motion import Motion
from pipeline.physics.term import NO_STATE, Parameter, Surroundings, Term


def soft_ramp(x: np.ndarray, rounding: float) -> np.ndarray:
    """max(x, 0) with its corner rounded over +-rounding [x's unit] by a parabola."""
    if rounding <= 0.0:
        return np.maximum(x, 0.0)
    bite = np.clip(x + rounding, 0.0, 2.0 * rounding)
    return bite * bite / (4.0 * rounding) + np.maximum(x - rounding, 0.0)


class Slack(Term):
    """x = ramp(u - c - w/2) - ramp(c - w/2 - u) + c: nothing moves within w/2 of the centre c.

    The corners are rounded over +-rounding. Source: dead-zone nonlinearity, Tao and Kokotovic,
    Adaptive Control of Systems with Actuator and Sensor Nonlinearities (1996).
    """

    name = "slack"
    site = "transmission"
    before_curve = True
    says = "Around home both wires hang slack: nothing moves over {width} of drive."

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        span, unit = around.drive_span, around.drive_unit
        middle = around.drive_low + 0.5 * span
        return (
            Parameter("width", unit, 0.0, 0.8 * span, 0.05 * span, 0.05 * span),
            Parameter(
                "centre", unit, middle - 0.35 * span, middle + 0.35 * span, middle, 0.05 * span
            ),
            Parameter("rounding", unit, 0.0, 0.2 * span, 0.01 * span, 0.02 * span),
        )

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        width, centre, rounding = values
        beyond = soft_ramp(signal - centre - 0.5 * width, rounding)
        below = soft_ramp(centre - 0.5 * width - signal, rounding)
        return centre + beyond - below, NO_STATE

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        span = around.drive_span
        middle = around.drive_low + 0.5 * span
        return np.array(
            [
                [width * span, middle + centre * span, 0.01 * span]
                for width in (0.02, 0.06, 0.15, 0.35)
                for centre in (-0.15, -0.05, 0.0, 0.05, 0.15)
            ]
        )

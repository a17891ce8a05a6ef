"""Slack: a dead zone around home, without a loop."""

import numpy as np

from pipeline.physics.balance import Load
from pipeline.physics.motion import Motion
from pipeline.physics.term import NO_STATE, Parameter, Surroundings, Term


def soft_ramp(x: np.ndarray, rounding: float) -> np.ndarray:
    """max(x, 0) with its corner rounded: rounding * log(1 + exp(x / rounding))."""
    if rounding <= 0.0:
        return np.maximum(x, 0.0)
    return rounding * np.logaddexp(0.0, x / rounding)


class Slack(Term):
    """Nothing moves within w/2 of the centre c, where both wires hang loose; corners are rounded.

    Form "free": x = c + ramp(u - c - w/2) - ramp(c - w/2 - u) on the drive. Form "loaded": in the
    balance, the wire gives way by w/2 against the sign of its force, so that whatever else loads the
    joint decides on which side it hangs. Source: dead-zone nonlinearity, Tao and Kokotovic, Adaptive
    Control of Systems with Actuator and Sensor Nonlinearities (1996).
    """

    name = "slack"
    site = "transmission"
    says = "Around home both wires hang slack: nothing moves over {width} of drive."

    def __init__(self, form: str = "free") -> None:
        self.form = form
        self.before_curve = form == "free"
        self.in_balance = form == "loaded"
        if self.in_balance:
            self.says = "Where its load changes sides, the wires hang slack over {width_at_joint}."

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        if self.in_balance:
            span, low = around.angle_span, around.angle_low
            unit, width = around.angle_unit, "width_at_joint"
        else:
            span, low = around.drive_span, around.drive_low
            unit, width = around.drive_unit, "width"
        middle, far = low + 0.5 * span, 0.35 * span
        own = (
            Parameter(width, unit, 0.0, 0.8 * span, 0.05 * span, 0.05 * span),
            Parameter("centre", unit, middle - far, middle + far, middle, 0.05 * span),
            Parameter("rounding", unit, 1e-5 * span, 0.02 * span, 0.002 * span, 0.002 * span),
        )
        if not self.in_balance:
            return own
        return (*own, Parameter("stiffness", "", 0.02, 2.0, 0.3, 0.05, weak=True))

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        width, centre, rounding = values
        beyond = soft_ramp(signal - centre - 0.5 * width, rounding)
        below = soft_ramp(centre - 0.5 * width - signal, rounding)
        return centre + beyond - below, NO_STATE

    def load(self, values: np.ndarray, motion: Motion) -> Load:
        width, centre, rounding, stiffness = values
        return Load(give=np.array([[0.5 * width, stiffness * rounding, stiffness, centre]]))

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        own = self.parameters(around)
        span, middle = own[0].high / 0.8, own[1].start
        rounding = own[2].start
        rests = [[rounding, 0.05], [rounding, 0.3]] if self.in_balance else [[rounding]]
        return np.array(
            [
                [width * span, middle + centre * span, *rest]
                for rest in rests
                for width in (0.02, 0.06, 0.15, 0.35)
                for centre in (-0.15, -0.05, 0.0, 0.05, 0.15)
            ]
        )

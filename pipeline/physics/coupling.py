"""Coupling: another axis's command moves this one."""

import numpy as np

from pipeline.physics.balance import Load
from pipeline.physics.motion import Motion
from pipeline.physics.term import Parameter, Surroundings, Term


class Coupling(Term):
    """A load gain * v + bend * v^2 on the joint, v the other axis's command (channel `form`).

    In the balance, so that friction, slack and contact answer to it; a free joint moves by as much.
    Source: wires of one joint that run through another, first two terms of the power series.
    """

    name = "coupling"
    site = "body"
    in_balance = True
    says = "The other axis moves this one too, by {gain} of its command."

    def __init__(self, form: str = "") -> None:
        self.form = form

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        other = max(0.5 * around.other_span.get(self.form, 1.0), 1e-9)
        reach = around.angle_span / other
        unit, bend = f"{around.angle_unit}/{around.other_unit}", reach / other
        return (
            Parameter("gain", unit, -reach, reach, 0.05 * reach, 0.05 * reach),
            Parameter("bend", f"{unit}^2", -bend, bend, 0.0, 0.02 * bend),
        )

    def load(self, values: np.ndarray, motion: Motion) -> Load:
        other = motion.others[self.form]
        return Load(pushed=other * (values[0] + values[1] * other))

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        return np.array([[self.parameters(around)[0].start, 0.0]])

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        return around.other_span.get(self.form, 0.0) > 0.0

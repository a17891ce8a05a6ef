"""Coupling: another axis's command moves this one."""

import numpy as np

from pipeline.physics.motion import Motion
from pipeline.physics.term import NO_STATE, Parameter, Surroundings, Term


class Coupling(Term):
    """theta + gain * v + bend * v^2, v the other axis's command; `form` is that channel's name.

    Source: wires of one joint that run through another, first two terms of the power series.
    """

    name = "coupling"
    site = "body"
    says = "The other axis moves this one too, by {gain} of its command."

    def __init__(self, form: str = "") -> None:
        self.form = form

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        reach = around.angle_span / max(0.5 * around.other_span.get(self.form, 1.0), 1e-9)
        unit = f"{around.angle_unit}/{around.other_unit}"
        bend = reach / max(0.5 * around.other_span.get(self.form, 1.0), 1e-9)
        return (
            Parameter("gain", unit, -reach, reach, 0.05 * reach, 0.05 * reach),
            Parameter("bend", f"{unit}^2", -bend, bend, 0.0, 0.02 * bend),
        )

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        other = motion.others[self.form]
        return signal + other * (values[0] + values[1] * other), NO_STATE

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        start = self.parameters(around)[0].start
        return np.array([[start, 0.0]])

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        return around.other_span.get(self.form, 0.0) > 0.0

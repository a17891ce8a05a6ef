"""Gravity: a deflection that depends on the absolute pose."""

import numpy as np

from pipeline.physics.balance import Load
from pipeline.physics.motion import Motion
from pipeline.physics.term import Parameter, Surroundings, Term


class Gravity(Term):
    """deflection * (sin(theta - zero) + sin(zero)) in the balance.

    The moment of a weight that hangs down at theta = zero, over the wire's stiffness; the
    deflection at home is part of the offset. Source: static moment of a pendulum.
    """

    name = "gravity"
    site = "body"
    in_balance = True
    group = "bend"
    says = "Its own weight bends it by up to {deflection}, depending on how it hangs."

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        span = around.angle_span
        return (
            Parameter("deflection", around.angle_unit, 0.0, 0.5 * span, 0.03 * span, 0.03 * span),
            Parameter("zero", "rad", -2.0 * np.pi, 2.0 * np.pi, 0.0, 0.0),
        )

    def load(self, values: np.ndarray, motion: Motion, state: np.ndarray | None) -> Load:
        return Load(smooth=(0.0, 0.0, float(values[0]), float(values[1])))

    def scaled(self, values: np.ndarray, factor: float) -> np.ndarray:
        out = super().scaled(values, abs(factor))
        if factor < 0.0:
            out[1] += np.pi
        return out

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        size = 0.02 * around.angle_span
        return np.array([[size, zero] for zero in np.arange(4) * np.pi / 4.0])

"""Compliance: the wire stretches, which lowers the gain and hardens."""

import numpy as np

from pipeline.physics.balance import Load
from pipeline.physics.motion import Motion
from pipeline.physics.term import Parameter, Surroundings, Term


class Compliance(Term):
    """Stretch under the joint's own stiffness: stretch * theta + hardening * theta^3 in the balance.

    stretch [1] is the joint's stiffness over the wire's, hardening [1/angle unit^2] the growth of
    the joint's stiffness with its angle. Source: two springs in series, one of Duffing's form.
    """

    name = "compliance"
    site = "transmission"
    in_balance = True
    says = "The wire stretches under the joint's stiffness, so that it moves less the further it bends."

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        half = 0.5 * around.angle_span
        unit = f"1/{around.angle_unit}^2"
        return (
            Parameter("hardening", unit, 0.0, 3.0 / half**2, 0.1 / half**2, 0.1 / half**2),
            Parameter("stretch", "", 0.0, 2.0, 0.02, 0.1),
        )

    def load(self, values: np.ndarray) -> Load:
        return Load(smooth=(float(values[1]), float(values[0]), 0.0, 0.0))

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        half = 0.5 * around.angle_span
        return np.array([[h / half**2, s] for h in (0.03, 0.3) for s in (0.0, 0.2)])

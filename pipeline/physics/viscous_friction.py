"""Viscous friction: a force against the motion that grows with its speed."""

from typing import ClassVar

import numpy as np

from pipeline.physics.force_term import ASYMMETRY, ForceTerm, both_ways, per, size
from pipeline.physics.motion import Kinetics, Motion
from pipeline.physics.pre_sliding import weighted
from pipeline.physics.term import Parameter, Surroundings


class ViscousFriction(ForceTerm):
    """F = damping * v.

    Form "asymmetric" differs for the two directions: damping * v (1 + asymmetry sgn v). Source:
    Stokes (1851); one coefficient for each direction as in Hamon, Gautier and Garrec, IROS 2010.
    """

    name = "viscous_friction"
    directed = True
    grows: ClassVar = {"": ("asymmetric",)}
    says = "Friction that grows with the speed holds back by {damping}."

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        most = 4.0 * around.angle_span / max(around.top_speed, 1e-12)
        own = size("damping", per(around, 1), most, around)
        return (own, ASYMMETRY) if self.form == "asymmetric" else (own,)

    def force(
        self, motion: Motion, kinetics: Kinetics, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray | None]:
        asymmetry = float(values[1]) if len(values) > 1 else 0.0
        return values[0] * weighted(kinetics.velocity, asymmetry), state

    def sentence(self, values: np.ndarray, around: Surroundings) -> str:
        asymmetry = float(values[1]) if len(values) > 1 else 0.0
        ways = both_ways(float(values[0]), asymmetry, per(around, 1))
        return f"Friction that grows with the speed holds back by {ways}."

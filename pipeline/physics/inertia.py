"""Inertia: a force that grows with the acceleration."""

from dataclasses import replace

import numpy as np

from pipeline.physics.force_term import ForceTerm, per, size
from pipeline.physics.motion import Kinetics, Motion
from pipeline.physics.term import Parameter, Surroundings


class Inertia(ForceTerm):
    """F = mass * x''. Source: Newton's second law.

    Only where the simulation has some mass may there be too much of it.
    """

    name = "inertia"
    place = 100.0
    means = "a force that grows with the acceleration"
    says = "A mass of {mass} has to be accelerated, beyond what the simulation counts."

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        most = 4.0 * around.angle_span / max(around.top_acceleration, 1e-12)
        return (size("mass", per(around, 2), most, replace(around, simulated=around.accelerating)),)

    def force(
        self, motion: Motion, kinetics: Kinetics, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray | None]:
        return values[0] * kinetics.acceleration, state

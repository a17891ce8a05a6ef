"""Stiffness: a force that grows with the position, like a spring's."""

from typing import ClassVar

import numpy as np

from pipeline.physics.force_term import ASYMMETRY, ForceTerm, per, size
from pipeline.physics.motion import Kinetics, Motion
from pipeline.physics.pre_sliding import weighted
from pipeline.physics.term import Parameter, Surroundings

MOST = 20.0


def farthest(around: Surroundings) -> float:
    """The largest position of either sign [drive unit]."""
    return max(abs(around.drive_low), abs(around.drive_low + around.drive_span), 1e-12)


class Stiffness(ForceTerm):
    """F = stiffness * x, x the position from its own zero; the rest is part of the offset.

    Forms: "asymmetric" differs for the two sides of zero, x (1 + asymmetry sgn x); "hardening" adds
    a cube, x (1 + hardening x^2). Source: Hooke's law; Duffing (1918).
    """

    name = "stiffness"
    place = 140.0
    grows: ClassVar = {"": ("asymmetric", "hardening")}
    means = "a force that grows with the position, like a spring's"
    says = "A spring of {stiffness} pushes back."

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        most = 4.0 * around.angle_span / max(around.drive_span, 1e-12)
        own = size("stiffness", per(around, 0), most, around)
        if self.form == "asymmetric":
            return (own, ASYMMETRY)
        if self.form == "hardening":
            far, unit = farthest(around), f"1/{around.drive_unit}^2"
            return (own, Parameter("hardening", unit, -1.0 / far**2, MOST / far**2, 0.0,
                                   0.5 / far**2))  # fmt: skip
        return (own,)

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        found = super().candidates(motion, around)
        if self.form == "hardening":
            found = np.repeat(found, 2, axis=0)
            found[1] = found[1, 0] / MOST, MOST / farthest(around) ** 2
        return found

    def force(
        self, motion: Motion, kinetics: Kinetics, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray | None]:
        x = motion.drive
        if self.form == "asymmetric":
            x = weighted(x, float(values[1]))
        elif self.form == "hardening":
            x = x * (1.0 + values[1] * x * x)
        return values[0] * x, state

"""A joint that stiffens as it bends."""

from typing import ClassVar

import numpy as np

from pipeline.physics.balance import Load
from pipeline.physics.compliance import STRETCH, Compliance
from pipeline.physics.motion import Motion
from pipeline.physics.term import Parameter, Surroundings

PROGRESSIVE = "progressive"


class StiffeningJoint(Compliance):
    """stretch * theta and, in form "joint", hardening * theta^3, in the balance.

    Form "progressive": rise * theta * |theta| instead, a joint that stiffens in proportion to its
    bend, rounded within `onset` of the middle. Source: Duffing (1918); springs of progressive rate,
    Wahl, Mechanical Springs (1963).
    """

    grows: ClassVar = {"joint": (PROGRESSIVE,)}

    def __init__(self, form: str = "joint") -> None:
        self.form = form

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        half, unit = 0.5 * around.angle_span, around.angle_unit
        if self.form == PROGRESSIVE:
            rise, edge = 0.1 / half, 0.05 * half
            onset = Parameter("onset", unit, 0.2 * edge, 20.0 * edge, edge, 0.0, weak=True)
            return (Parameter("rise", f"1/{unit}", 0.0, 30 * rise, rise, rise), STRETCH, onset)
        hard = 0.1 / half**2
        return (Parameter("hardening", f"1/{unit}^2", 0.0, 30 * hard, hard, hard), STRETCH)

    def void(self, values: np.ndarray) -> bool:
        return bool(values[0] == 0.0 and values[1] == 0.0)

    def load(self, values: np.ndarray, motion: Motion, state: np.ndarray | None) -> Load:
        if self.form == PROGRESSIVE:
            rise, stretch, onset = values
            sides = np.array([[1.0], [-1.0]])
            contact = sides * [1.0 / onset, 0.0, 0.0, rise * onset**2]
            return Load(contact=contact, smooth=(float(stretch), 0.0, 0.0, 0.0))
        return Load(smooth=(float(values[1]), float(values[0]), 0.0, 0.0))

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        half = 0.5 * around.angle_span
        if self.form == PROGRESSIVE:
            return np.array([[rise / half, 0.0, 0.05 * half] for rise in (0.03, 0.1, 0.3)])
        return np.array([[h / half**2, s] for h in (0.03, 0.3) for s in (0.0, 0.2)])

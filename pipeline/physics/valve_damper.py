"""A damper with a valve: its force goes by a power of the speed, until the valve blows off."""

from dataclasses import replace
from itertools import product
from typing import ClassVar

import numpy as np

from pipeline.physics.force_term import ASYMMETRY, ForceTerm, both_ways, resistance
from pipeline.physics.motion import Kinetics, Motion
from pipeline.physics.pre_sliding import weighted
from pipeline.physics.term import Parameter, Surroundings

EXPONENTS, POWER = (0.4, 0.7, 1.5), (0.2, 2.0)
RELIEF, LEAST_RELIEF = 0.4, 1e-3
BEYOND = (0.5, 2.0, 8.0)
GOES = "and goes with the speed to the power of"


class ValveDamper(ForceTerm):
    """F = damping |v|^exponent sgn v.

    Form "relieved" blows off at the force `relief`: relief tanh(damping |v|^exponent / relief) sgn
    v, and is no correction of what the simulation has. Each of them also "asymmetric": 1 +
    asymmetry sgn v times as large. Source: Constantinou and Symans, Struct. Des. Tall Build. 2
    (1993) 93 (power); Duym, Veh. Syst. Dyn. 33 (2000) 85 (the blow-off of a shock absorber's
    valve).
    """

    name = "viscous_friction"
    place = 120.0
    directed = True
    grows: ClassVar = {
        "power": ("asymmetric power", "relieved"),
        "relieved": ("asymmetric relieved",),
    }

    def __init__(self, form: str = "power") -> None:
        self.form = form
        self.blows_off, self.sided = "relieved" in form, "asymmetric" in form

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        top, force = max(around.top_speed, 1e-12), around.angle_span
        most = 4.0 * force / min(top**exponent for exponent in POWER)
        by_speed = f"{around.angle_unit} per {around.drive_unit}/s to the exponent"
        own: tuple[Parameter, ...] = (
            resistance("damping", by_speed, most, around),
            Parameter("exponent", "", *POWER, 1.0, 0.5),
        )
        if self.blows_off:
            own = (replace(own[0], low=0.0), own[1])
            own += (Parameter("relief", around.angle_unit, LEAST_RELIEF * force, 4.0 * force,
                              RELIEF * force, 0.0, relative=True),)  # fmt: skip
        return (*own, ASYMMETRY) if self.sided else own

    def force(
        self, motion: Motion, kinetics: Kinetics, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray | None]:
        force = values[0] * np.abs(kinetics.velocity) ** values[1]
        if self.blows_off:
            force = values[2] * np.tanh(force / values[2])
        return weighted(np.sign(kinetics.velocity) * force, self.asymmetry(values)), state

    def asymmetry(self, values: np.ndarray) -> float:
        """How much more it holds back while the position rises."""
        return float(values[-1]) if self.sided else 0.0

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        start = {p.name: p.start for p in self.parameters(around)}
        top, relief = max(around.top_speed, 1e-12), RELIEF * around.angle_span
        shares = BEYOND if self.blows_off else (0.05 / RELIEF,)
        rows = []
        for exponent, share in product(EXPONENTS, shares):
            damping = share * relief / top**exponent
            own = {**start, "damping": damping, "exponent": exponent, "relief": relief}
            rows.append([own[name] for name in start])
        return np.array(rows)

    def scaled(self, values: np.ndarray, factor: float) -> np.ndarray:
        out = super().scaled(values, factor)
        if self.blows_off:
            out[2] *= abs(factor)
        return out

    def sentence(self, values: np.ndarray, around: Surroundings) -> str:
        ways = both_ways(float(values[0]), self.asymmetry(values), around.angle_unit)
        told = (
            f"Friction that grows with the speed holds back by {ways} at 1 {around.drive_unit}/s, "
            f"{GOES} {values[1]:.2g}."
        )
        if not self.blows_off:
            return told
        off = both_ways(float(values[2]), self.asymmetry(values), around.angle_unit)
        return f"{told} At {off} its valve blows off."

"""Gravity: a deflection that depends on the absolute pose."""

from typing import ClassVar

import numpy as np

from pipeline.physics.balance import Load
from pipeline.physics.contact import pretension
from pipeline.physics.force_units import FORCES
from pipeline.physics.motion import Motion
from pipeline.physics.term import Parameter, Surroundings, Term

LEAST_PRETENSION = 0.03
SAGGING = "sagging"


class Gravity(Term):
    """deflection * (sin(theta - zero) + sin(zero)) in the balance.

    The moment of a weight that hangs down at theta = zero, over the wire's stiffness; the
    deflection at home is part of the offset, as of a robot that was set to zero where it hung; in
    form "sagging" it is not, as of one whose simulation knows its frame's zero. A weight in form
    "unloading" pulls so hard that beyond `pretension` one of two wires hangs slack; with much less
    of that, any load would do so. Source: static moment of a pendulum.
    """

    name = "gravity"
    site = "body"
    in_balance = True
    group = "bend"
    grows: ClassVar = {"": ("unloading",)}
    means = "deflection that depends on the absolute pose"
    says = "Its own weight bends it by up to {deflection}, depending on how it hangs."

    @property
    def kin(self) -> str:
        return "" if self.form == SAGGING else self.form

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        span, unit = around.angle_span, around.angle_unit
        own = (
            Parameter("deflection", unit, 0.0, 0.5 * span, 0.03 * span, 0.03 * span),
            Parameter("zero", "rad", -2.0 * np.pi, 2.0 * np.pi, 0.0, 0.0),
        )
        return (*own, pretension(around, LEAST_PRETENSION)) if self.form == "unloading" else own

    def load(self, values: np.ndarray, motion: Motion, state: np.ndarray | None) -> Load:
        weight, zero = float(values[0]), float(values[1])
        return Load(
            smooth=(0.0, 0.0, weight, zero),
            pretension=values[2] if len(values) > 2 else np.inf,
            torque=np.full(len(motion), weight * np.sin(zero)) if self.form == SAGGING else None,
        )

    def scaled(self, values: np.ndarray, factor: float) -> np.ndarray:
        out = super().scaled(values, abs(factor))
        if factor < 0.0:
            out[1] += np.pi
        return out

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        """Not of a force behind a force: it has no pose."""
        return around.angle_unit not in FORCES and super().excited(motion, around)

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        sizes = [0.15, 0.05] if self.form == "unloading" else [0.02]
        weight, *tail = (share * around.angle_span for share in sizes)
        return np.array([[weight, zero, *tail] for zero in np.arange(4) * np.pi / 4.0])

    def retold(self, starts: np.ndarray) -> np.ndarray:
        """Where a wire hangs slack, less weight that is more upright at home does about as much."""
        if self.form != "unloading":
            return starts
        weight, zero, _ = starts[0]
        zeros = zero + np.sign(np.sin(zero)) * np.array([0.0, 0.2, 0.4])
        zeros = np.remainder(zeros + np.pi, 2.0 * np.pi) - np.pi
        return np.array([[0.7 * weight, zero, 0.4 * weight] for zero in zeros])

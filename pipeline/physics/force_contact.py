"""Contact of a force against motion: a second spring that is met at a position."""

from typing import ClassVar

import numpy as np

from pipeline.number_words import worded
from pipeline.physics.contact import SIDES
from pipeline.physics.force_term import ForceTerm, per
from pipeline.physics.motion import Kinetics, Motion
from pipeline.physics.term import Parameter, Surroundings

BUFFER, ROUND, DAMPED = "buffer", "round buffer", "damped buffer"
SHARES = (0.02, 0.06, 0.12, 0.2, 0.3, 0.45)
STEEPEST = 50.0
SKIN, DEEP, HERTZ, MOST_ROUND = 0.01, 0.1, 0.5, 1.5
MOST_DAMPED = 5.0


class ForceContact(ForceTerm):
    """F = side * stiffness * z, z = skin * log(1 + exp(side * (x - position) / skin)).

    A spring that pushes only beyond a position: a buffer, a bump stop. Forms "upper buffer" and
    "lower buffer" are its sides. A "round buffer" gets stiffer the deeper it is pressed in, as
    rubber and round bodies are: F = side * stiffness * z * (z / deep)^roundness, its stiffness
    being that of the chord at `deep`. A "damped buffer" pushes more while it is pressed in and less
    while it is let go, F (1 + side * loss * v), and never pulls. Sources: unilateral spring; Hertz
    (1882), a roundness of 0.5; Hunt and Crossley, J. Appl. Mech. 42 (1975) 440.
    """

    name = "contact"
    unlikely = 2.0
    grows: ClassVar = {
        f"{side} {form}": (f"{side} {richer}",)
        for side in SIDES
        for form, richer in ((BUFFER, ROUND), (ROUND, DAMPED))
    }
    says = "Beyond {position} on one side it touches a spring of {stiffness} more."

    def __init__(self, form: str = f"{SIDES[0]} {BUFFER}") -> None:
        self.form = form
        self.place = 150.0 if self.side > 0.0 else 160.0

    @property
    def side(self) -> float:
        """1 of the upper side, -1 of the lower one."""
        return 1.0 if self.form.startswith(SIDES[0]) else -1.0

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        span, unit = max(around.drive_span, 1e-12), around.drive_unit
        low, usual = around.drive_low, around.angle_span / span
        own = (
            Parameter("stiffness", per(around, 0), 0.0, STEEPEST * usual, usual, usual),
            Parameter("position", unit, low, low + span, low + (0.5 + 0.3 * self.side) * span, 0.0),
            Parameter("skin", unit, 1e-3 * span, 0.06 * span, SKIN * span, SKIN * span),
        )
        kind = self.form.partition(" ")[2]
        if kind == BUFFER:
            return own
        deep, pace = DEEP * span, max(around.top_speed, 1e-12)
        rounded = (
            *own,
            Parameter("roundness", "", 0.0, MOST_ROUND, HERTZ, 0.0),
            Parameter("deep", unit, deep, deep, deep, 0.0, weak=True),
        )
        if kind == ROUND:
            return rounded
        most = MOST_DAMPED / pace
        return (*rounded, Parameter("loss", f"s/{unit}", 0.0, most, 0.1 / pace, 0.3 / pace))

    def force(
        self, motion: Motion, kinetics: Kinetics, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray | None]:
        stiffness, position, skin, *more = values
        depth = skin * np.logaddexp(0.0, self.side * (motion.drive - position) / skin)
        if more:
            roundness, deep, *loss = more
            depth = depth * (depth / deep) ** roundness
            if loss:
                depth = depth * np.maximum(1.0 + self.side * loss[0] * kinetics.velocity, 0.0)
        return self.side * stiffness * depth, state

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        stiffness, _, *own = (p.start for p in self.parameters(around))
        end = around.drive_low + (0.5 + 0.5 * self.side) * around.drive_span
        places = [end - self.side * share * around.drive_span for share in SHARES]
        return np.array([[stiffness, place, *own] for place in places])

    def sentence(self, values: np.ndarray, around: Surroundings) -> str:
        """The position with its sign: it has a side."""
        way = "Above" if self.side > 0.0 else "Below"
        at = f"{worded(values[1])} {around.drive_unit}"
        return f"{way} {at} it touches a spring of {worded(values[0])} {per(around, 0)} more."

"""Coupling: another axis's command moves this one."""

import numpy as np

from pipeline.physics.motion import Motion
from pipeline.physics.term import NO_STATE, Parameter, Surroundings, Term


class Coupling(Term):
    """theta + gain * v + bend * v^2, v the other axis's command.

    `other` is that channel. It moves the joint itself, or, `by_wire`, the drive's end of the wire, so
    that play, slack and friction hold it back too (then v adds to the drive, in its unit). Source:
    wires of one joint that run through another, first two terms of the power series.
    """

    name = "coupling"
    site = "body"
    says = "The other axis moves this one too, by {gain} of its command."

    def __init__(self, other: str = "", by_wire: bool = False) -> None:
        self.other = other
        self.form = f"{other} by wire" if by_wire else other
        self.before_curve = by_wire

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        other = max(0.5 * around.other_span.get(self.other, 1.0), 1e-9)
        reach = (around.drive_span if self.before_curve else around.angle_span) / other
        moved = around.drive_unit if self.before_curve else around.angle_unit
        unit = f"{moved}/{around.other_unit}"
        bend = reach / other
        return (
            Parameter("gain", unit, -reach, reach, 0.05 * reach, 0.05 * reach),
            Parameter("bend", f"{unit}^2", -bend, bend, 0.0, 0.02 * bend),
        )

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        other = motion.others[self.other]
        return signal + other * (values[0] + values[1] * other), NO_STATE

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        return np.array([[self.parameters(around)[0].start, 0.0]])

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        return around.other_span.get(self.other, 0.0) > 0.0

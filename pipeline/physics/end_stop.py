"""End stop: no motion beyond an angle."""

import numpy as np

from pipeline.physics.balance import Load
from pipeline.physics.motion import Motion
from pipeline.physics.term import Parameter, Surroundings, Term

HARDEST, USUAL, SOFTEST = 0.004, 0.02, 0.08


class EndStop(Term):
    """As a contact, but much stiffer than the wire, which gives way instead.

    The stop itself gives by `give` of what the wire does: its stiffness is 1 / give of the wire's.
    It is met over `softness` round its angle. Forms "upper" and "lower" are its sides. Source:
    unilateral constraint, penalty form.
    """

    name = "end_stop"
    site = "body"
    in_balance = True
    holds = True
    means = "no motion beyond an angle"
    says = "It can't move beyond {angle}: it hits a stop."

    def __init__(self, form: str = "upper") -> None:
        self.form = form

    @property
    def side(self) -> float:
        return 1.0 if self.form == "upper" else -1.0

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        span, unit = around.angle_span, around.angle_unit
        middle = around.angle_low + 0.5 * span
        ends = sorted((middle, middle + 0.6 * self.side * span))
        return (
            Parameter(
                "angle", unit, ends[0], ends[1], middle + 0.4 * self.side * span, 0.0, place=True
            ),
            Parameter("softness", unit, 1e-4 * span, 0.03 * span, 0.003 * span, 0.005 * span),
            Parameter("give", "", HARDEST, SOFTEST, USUAL, 0.1 * USUAL, weak=True),
        )

    def load(self, values: np.ndarray, motion: Motion, state: np.ndarray | None) -> Load:
        angle, softness, give = values.tolist()
        contact = [[self.side / softness, angle, self.side * softness / give, 0.0]]
        return Load(contact=np.array(contact))

    def void(self, values: np.ndarray) -> bool:
        return False

    def scaled(self, values: np.ndarray, factor: float) -> np.ndarray:
        return values.copy()

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        middle, span = around.angle_low + 0.5 * around.angle_span, around.angle_span
        shares = (0.15, 0.25, 0.32, 0.38, 0.42, 0.45, 0.47, 0.485, 0.494)
        return np.array([[middle + self.side * s * span, 0.003 * span, USUAL] for s in shares])

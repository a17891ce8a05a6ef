"""One wire softer than the other: the joint gives way more to one side."""

import numpy as np

from pipeline.physics.balance import Load
from pipeline.physics.compliance import Compliance, centre, centres
from pipeline.physics.motion import Motion
from pipeline.physics.term import Parameter, Surroundings

UPPER, LOWER = "upper", "lower"
GRADUAL = 0.12


class SofterSide(Compliance):
    """softness * width * log(1 + exp(+-(theta - centre) / width)), in the balance.

    The wire that pulls to that side, "upper" or "lower", is the softer one, and takes over from the
    other over a `width`. Source: two springs in series on each side; the softplus log(1 + exp x)
    between them, Dugas et al., NIPS 13 (2000).
    """

    def __init__(self, form: str = UPPER) -> None:
        self.form = form

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        half = 0.5 * around.angle_span
        return (
            Parameter("softness", "", 0.0, 2.0, 0.2, 0.2),
            centre(around),
            Parameter("width", around.angle_unit, GRADUAL * half, half, 0.2 * half, 0.0),
        )

    def load(self, values: np.ndarray, motion: Motion, state: np.ndarray | None) -> Load:
        (softness, middle, width), side = values, 1.0 if self.form == UPPER else -1.0
        return Load(contact=side * np.array([[1.0 / width, side * middle, softness * width, 0.0]]))

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        width = 0.2 * (0.5 * around.angle_span)
        return np.array([[0.2, middle, width] for middle in centres(around, (-0.3, 0.0, 0.3))])

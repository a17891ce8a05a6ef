"""What motors have in common that have a top speed: they come late, before gears and wires."""

import numpy as np

from pipeline.physics.term import Term


class LimitedMotor(Term):
    """A motor that does the more, the slower it is."""

    name = "response_lag"
    site = "body"
    place = 0.0
    remembers = "time"
    group = "lag"
    timed = True
    before_curve = True

    def scaled(self, values: np.ndarray, factor: float) -> np.ndarray:
        """As it is: no size makes it do nothing."""
        return values.copy()

    def void(self, values: np.ndarray) -> bool:
        return False

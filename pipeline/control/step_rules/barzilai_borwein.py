"""Gradient descent with the step of Barzilai & Borwein (1988), their first formula."""

from pipeline.config import BarzilaiBorweinConfig
from pipeline.control.step_rules.base import Point, PointAt


class BarzilaiBorwein:
    """The step is the last change of the command over the last change of the gradient."""

    def __init__(self, config: BarzilaiBorweinConfig) -> None:
        self._step = config.initial
        self._last: Point | None = None

    def propose(self, here: Point, point_at: PointAt) -> float:
        if self._last is not None:
            moved = here.command_deg - self._last.command_deg
            bent = here.gradient - self._last.gradient
            if moved * bent > 0.0:
                self._step = moved / bent
        self._last = here
        return here.command_deg - self._step * here.gradient

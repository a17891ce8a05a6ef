"""Gradient descent with one step size."""

from pipeline.config import ConstantConfig
from pipeline.control.step_rules.base import Point, PointAt


class Constant:
    """Converges when the step is below 2 / slope^2; crawls where the branch is flat."""

    def __init__(self, config: ConstantConfig) -> None:
        self._step = config.step

    def propose(self, here: Point, point_at: PointAt) -> float:
        return here.command_deg - self._step * here.gradient

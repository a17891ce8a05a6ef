"""Gradient descent with a step that shrinks: initial / (number of the step)^power."""

from pipeline.config import DiminishingConfig
from pipeline.control.step_rules.base import Point, PointAt


class Diminishing:
    """Safe without knowing the slope, at the price of ever slower steps."""

    def __init__(self, config: DiminishingConfig) -> None:
        self._config = config
        self._count = 0

    def propose(self, here: Point, point_at: PointAt) -> float:
        self._count += 1
        step = self._config.initial / self._count**self._config.power
        return here.command_deg - step * here.gradient

"""Gradient descent whose step is halved until the cost falls enough (Armijo 1966)."""

from pipeline.config import ArmijoConfig
from pipeline.control.step_rules.base import Point, PointAt

SMALLEST_STEP = 1e-12


class Armijo:
    """Each search begins one step size above the last accepted one, so that steps can grow too.

    With a demanded slope share of 1/4 and halving, the error at least halves at each step on a
    straight piece of branch, however flat that is once the step has grown to it.
    """

    def __init__(self, config: ArmijoConfig) -> None:
        self._config = config
        self._step = config.initial

    def propose(self, here: Point, point_at: PointAt) -> float:
        config = self._config
        step = self._step
        demanded = config.slope_share * here.gradient**2
        while (
            step > SMALLEST_STEP
            and point_at(here.command_deg - step * here.gradient).cost > here.cost - step * demanded
        ):
            step *= config.shrink
        self._step = step / config.shrink
        return here.command_deg - step * here.gradient

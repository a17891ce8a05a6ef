"""Newton's step for the root of the error: quadratic near the target."""

from pipeline.config import NewtonConfig
from pipeline.control.step_rules.base import Point, PointAt


class Newton:
    """The command at which the branch's tangent meets the target."""

    def __init__(self, config: NewtonConfig) -> None:
        pass

    def propose(self, here: Point, point_at: PointAt) -> float:
        return here.command_deg - here.error_deg / here.slope

"""What the step rules share: the point they stand at, and what they are asked."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol


@dataclass(frozen=True)
class Point:
    """A command tried by a search: the angle's error and slope there."""

    command_deg: float
    error_deg: float
    slope: float

    @property
    def cost(self) -> float:
        """Half the squared error [deg^2]: what a search makes small."""
        return 0.5 * self.error_deg**2

    @property
    def gradient(self) -> float:
        """Derivative of the cost by the command [deg]."""
        return self.error_deg * self.slope


PointAt = Callable[[float], Point]


class StepRule(Protocol):
    """Proposes the next command of a search; made anew for each target."""

    def propose(self, here: Point, point_at: PointAt) -> float:
        """The next command [deg]. `point_at` tries one, within the search's bounds."""
        ...

"""What acquisition needs of a robot, whatever moves it."""

from collections.abc import Mapping
from typing import Protocol

from pipeline.errors import LoopgapError


class HardwareError(LoopgapError):
    """A robot or camera could not do its part."""


class Robot(Protocol):
    """A robot whose axes are turned by motor shafts; all angles are degrees of shaft."""

    @property
    def limits_deg(self) -> Mapping[str, float]:
        """How far each axis may go to either side of its home."""
        ...

    def start(self) -> None:
        """Clear faults, configure, home where it stands, and enable every axis."""
        ...

    def move_to(self, angles_deg: Mapping[str, float]) -> None:
        """Move the named axes together; return when all stand at their angles."""
        ...

    def read_deg(self) -> dict[str, float]:
        """The encoder's angle of every axis."""
        ...

    def stop(self) -> None:
        """Quick stop, wait for standstill, disable: each axis, whatever happens to another."""
        ...

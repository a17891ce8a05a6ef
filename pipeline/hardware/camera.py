"""What acquisition needs of a camera, whatever takes the pictures."""

from typing import Protocol


class Camera(Protocol):
    """One camera that looks at one axis."""

    @property
    def name(self) -> str:
        """The axis that it sees."""
        ...

    def grab(self) -> bytes:
        """One JPEG-encoded image, taken now."""
        ...

    def close(self) -> None:
        """Give the device back."""
        ...

"""Where the frames of a recording are."""

from dataclasses import dataclass
from pathlib import Path
from typing import Protocol


class Frames(Protocol):
    """The frames of one camera, one for each row of a recording; read by several threads."""

    def read(self, row: int) -> bytes | None:
        """The encoded frame of a row, None where it was lost."""
        ...

    def where(self, row: int) -> str:
        """Where that frame is, for messages."""
        ...


@dataclass(frozen=True)
class FrameFolder:
    """Frames as a recording keeps them: `frames/<camera>_<row, six digits>.jpg` in its folder."""

    recording_folder: Path
    camera: str

    def path(self, row: int) -> Path:
        return self.recording_folder / "frames" / f"{self.camera}_{row:06d}.jpg"

    def read(self, row: int) -> bytes | None:
        path = self.path(row)
        return path.read_bytes() if path.is_file() else None

    def where(self, row: int) -> str:
        return str(self.path(row))

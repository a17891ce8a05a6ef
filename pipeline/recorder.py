"""Recording while it happens: each sample and its frames are on disk before the next step."""

import math
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import TracebackType

from pipeline.errors import LoopgapError, refusal
from pipeline.recording import CONTEXT_COLUMNS, Channel, write_head

WHOLE_COLUMNS = ("cycle", "step")


class Recorder:
    """A recording folder that grows row by row and can be loaded at any moment.

    Frames are written (whole or not at all) before the row that they belong to, as
    `frames/<camera>_<row>.jpg`. A folder that already holds a recording is refused.
    """

    def __init__(self, folder: Path, channels: Sequence[Channel], source: str) -> None:
        self._folder = folder
        self._columns = (*CONTEXT_COLUMNS, *(channel.name for channel in channels))
        self._rows = 0
        if (folder / "recording.json").exists():
            raise LoopgapError(
                refusal(str(folder), "a folder without a recording", "recording.json in it",
                        "Let this run write elsewhere with `hydra.run.dir=OUT`.")
            )  # fmt: skip
        try:
            (folder / "frames").mkdir(parents=True, exist_ok=True)
            write_head(channels, source, folder)
            flags = os.O_CREAT | os.O_EXCL | os.O_WRONLY | os.O_APPEND
            self._file = os.open(folder / "samples.csv", flags, 0o644)
            self._append(",".join(self._columns))
            _sync(folder)
            _sync(folder.parent)
        except OSError as error:
            raise _unwritable(folder, error) from error

    def write(self, row: Mapping[str, float], frames: Mapping[str, bytes]) -> None:
        """Put one sample (a number for each column) and its JPEG frames, by camera, on disk."""
        if set(row) != set(self._columns):
            raise LoopgapError(
                refusal(str(self._folder), f"a sample of {', '.join(self._columns)}",
                        ", ".join(row), "Give one number for each channel.")
            )  # fmt: skip
        try:
            for camera, image in frames.items():
                self._write_frame(f"{camera}_{self._rows:06d}.jpg", image)
            self._append(",".join(_cell(name, row[name]) for name in self._columns))
        except OSError as error:
            raise _unwritable(self._folder, error) from error
        self._rows += 1

    def close(self) -> None:
        """Give the file back; all rows are on disk already."""
        os.close(self._file)

    def __enter__(self) -> "Recorder":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def _append(self, line: str) -> None:
        size = os.fstat(self._file).st_size
        data = f"{line}\n".encode()
        if os.write(self._file, data) != len(data):
            os.ftruncate(self._file, size)
            raise OSError("no space for another row")
        os.fsync(self._file)

    def _write_frame(self, name: str, image: bytes) -> None:
        part = self._folder / "frames" / f".{name}.part"
        with part.open("wb") as file:
            file.write(image)
            file.flush()
            os.fsync(file.fileno())
        part.replace(self._folder / "frames" / name)


def _cell(column: str, value: float) -> str:
    if column in WHOLE_COLUMNS:
        return str(int(value))
    return "" if math.isnan(value) else repr(float(value))


def _sync(folder: Path) -> None:
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _unwritable(folder: Path, error: OSError) -> LoopgapError:
    return LoopgapError(
        refusal(str(folder), "a folder that can be written", f"{error}",
                "Free or unlock it, or let the run write elsewhere with `hydra.run.dir=OUT`.")
    )  # fmt: skip

"""What is known of a stage's result: its key, its files and their hashes, when and how it came."""

import json
from dataclasses import asdict, dataclass, field, fields
from pathlib import Path
from typing import Any

from pipeline.atomically import write_atomically

SCHEMA = "loopgap.stage/1"
RECORDS = ".stages"
BEGUN = ".begun"
RAN, FROM_CACHE, FROM_BEFORE = "ran", "cache", "before"


@dataclass(frozen=True)
class StageRecord:
    """The result of one stage.

    `inputs` and `outputs`: name -> SHA-256, outputs relative to the run's folder. `made`: `ran`,
    `cache` or `before` (in this folder, by an earlier try). `began` and `wall_time_s` are of the
    time when it ran, wherever that was; `said` is what it printed.
    """

    stage: str
    key: str
    began: str
    wall_time_s: float
    made: str = RAN
    inputs: dict[str, str] = field(default_factory=dict)
    outputs: dict[str, str] = field(default_factory=dict)
    said: str = ""

    def as_json(self) -> str:
        """Text that `from_json` takes back."""
        return json.dumps({"schema": SCHEMA} | asdict(self), indent=1)

    @classmethod
    def from_json(cls, text: str) -> "StageRecord":
        """The record; ValueError if it is none."""
        entry: Any = json.loads(text)
        names = {f.name for f in fields(cls)}
        if not isinstance(entry, dict) or set(entry) != names | {"schema"}:
            raise ValueError("no record of a stage")
        return cls(**{name: entry[name] for name in names})


def record_file(folder: Path, stage: str) -> Path:
    """Where a run's folder keeps what is known of a stage."""
    return folder / RECORDS / f"{stage}.json"


def read_record(folder: Path, stage: str) -> StageRecord | None:
    """The record of a stage in a run's folder; None where there is none that can be read."""
    try:
        return StageRecord.from_json(record_file(folder, stage).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None


def write_record(folder: Path, record: StageRecord) -> None:
    """Say in a run's folder that a stage's result is whole."""
    file = record_file(folder, record.stage)
    write_atomically(file, record.as_json())
    file.with_suffix(BEGUN).unlink(missing_ok=True)


def begin(folder: Path, stage: str) -> None:
    """Say in a run's folder that what lies there of a stage is ours, and not whole."""
    file = record_file(folder, stage)
    file.parent.mkdir(parents=True, exist_ok=True)
    file.with_suffix(BEGUN).touch()
    file.unlink(missing_ok=True)


def has_begun(folder: Path, stage: str) -> bool:
    """Whether a try of ours left, or may have left, something of a stage in a run's folder."""
    file = record_file(folder, stage)
    return file.exists() or file.with_suffix(BEGUN).exists()

"""The schema of a mapping: which columns of somebody's files are which channels."""

from dataclasses import dataclass, field

from omegaconf import MISSING


@dataclass
class ImportedTime:
    """Where a table's time comes from: a column in a unit (or `date`), or a rate.

    With a rate the first row is `start_s` after the first sample of the first table.
    """

    column: str | None = None
    unit: str = "s"
    rate_hz: float | None = None
    start_s: float = 0.0


@dataclass
class ImportedChannel:
    """One channel: sign * scale * (the column, converted from `from_unit` to `unit`) + offset.

    `column` is a name, an index from 0 or a dotted path; without it the channel's own name.
    `scale` is in `unit` per `from_unit` where these measure different things (counts, volts).
    `fill` (previous or linear) fills empty commands, which are refused otherwise.
    """

    role: str = MISSING
    column: str | None = None
    unit: str = ""
    from_unit: str | None = None
    scale: float | None = None
    offset: float = 0.0
    sign: int = 1
    of: str | None = None
    fill: str | None = None


@dataclass
class ReadingConfig:
    """How a file is read, where it doesn't say so itself; null means: look.

    `separator`, `decimal`, `header`, `encoding`, `comment`, `skip_rows` (before the header) and
    `skip_after_header` are for text; `sheet` for xlsx; `root` (a dotted path) for JSON and mat;
    `topic` for bags.
    """

    separator: str | None = None
    decimal: str = "."
    header: bool | None = None
    encoding: str | None = None
    comment: str | None = None
    skip_rows: int = 0
    skip_after_header: int = 0
    sheet: str | None = None
    root: str | None = None
    topic: str | None = None


@dataclass
class ImportedTable:
    """One file (or folder of npy files, or topic of a bag): its time and its channels.

    `file` is a pattern below `importing.path`; without it the table is `importing.path` itself.
    `resample` (linear, previous or nearest) brings it to the first table's times.
    `frames` names the camera whose images, those of a bag's topic, go to the recording's frames.
    `on_time_going_back` (drop or sort) allows rows that are not later than those before them.
    """

    file: str | None = None
    reading: ReadingConfig = field(default_factory=ReadingConfig)
    time: ImportedTime = field(default_factory=ImportedTime)
    resample: str | None = None
    on_time_going_back: str | None = None
    frames: str | None = None
    channels: dict[str, ImportedChannel] = field(default_factory=dict)


@dataclass
class ImportedRows:
    """Which rows are kept: from `start_s` up to but not including `end_s`, each `every`th."""

    start_s: float | None = None
    end_s: float | None = None
    every: int = 1


@dataclass
class ImportingConfig:
    """A mapping from files to a recording; the first table's rows are the recording's rows."""

    path: str | None = None
    source: str = "imported"
    tables: dict[str, ImportedTable] = field(default_factory=dict)
    rows: ImportedRows = field(default_factory=ImportedRows)

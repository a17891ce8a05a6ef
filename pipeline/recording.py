"""A recording: samples of named channels with units and roles, and the folder that holds it."""

import hashlib
import json
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pandas as pd

from pipeline.atomically import write_atomically
from pipeline.errors import RecordingError as RecordingError
from pipeline.errors import did_you_mean, refusal
from pipeline.leading import leading_command
from pipeline.sample_table import check_time, read_sample_table

SCHEMA = "loopgap.recording/1"
CONTEXT_COLUMNS = ("time_s", "cycle", "step")
ROLES = ("command", "measurement", "simulation", "encoder", "other")
NAME_UNITS = (
    "deg", "rad", "m", "mm", "um", "px", "n", "mn", "nm", "v", "a", "ma", "qc", "rpm",
    "deg_s", "rad_s", "m_s", "mm_s", "m_s2",
)  # fmt: skip
LETTERS: Mapping[str, tuple[frozenset[str], tuple[str, ...]]] = {
    "m": (
        frozenset({"mm", "um"}),
        ("position", "displacement", "distance", "travel", "stroke", "length"),
    ),
    "n": (frozenset({"mn"}), ("force", "load", "tension", "pull")),
    "v": (frozenset(), ("voltage",)),
    "a": (frozenset({"ma"}), ("current",)),
}
"""Units of one letter, which as well end names (`theta_m`, of a motor): units of the same kind, and
words before the letter that say that it is the unit."""

REVERSAL_SHARE = 0.01
MOST_CYCLES = 10**9
LONGEST_STEM = 100
FEWEST_PERIODS, MOST_WAYS, SAME_COMMAND, MOST_ROWS = 3, 12, 0.05, 0.9


@dataclass(frozen=True)
class Channel:
    """One column of samples: name, role, unit; `of` names what a simulation simulates."""

    name: str
    role: str
    unit: str
    of: str | None = None

    def as_json(self) -> dict[str, str]:
        entry = {"name": self.name, "role": self.role, "unit": self.unit}
        return entry | {"of": self.of} if self.of else entry


@dataclass(frozen=True)
class Recording:
    """Samples (one row each: `time_s`, `cycle`, `step`, then the channels) and what they mean.

    `samples` always has the three context columns; empty measurements are NaN.
    """

    samples: pd.DataFrame
    channels: tuple[Channel, ...]
    source: str = "real"

    def channel(self, name: str) -> Channel:
        """The channel called `name`; RecordingError names those that exist."""
        for channel in self.channels:
            if channel.name == name:
                return channel
        names = [c.name for c in self.channels]
        raise RecordingError(
            refusal("recording", f"a channel {name!r}", f"channels {', '.join(names)}",
                    f"{did_you_mean(name, names)}Name one of these.")
        )  # fmt: skip

    def with_role(self, role: str) -> tuple[Channel, ...]:
        """All channels of a role, in their order."""
        return tuple(c for c in self.channels if c.role == role)

    def values(self, name: str) -> np.ndarray:
        """Samples of a channel or context column, shape (n,), float; NaN where not measured."""
        return self.samples[name].to_numpy(dtype=float)

    def simulation_of(self, measurement: str) -> Channel | None:
        """The simulation channel of a measurement, if the recording carries one."""
        simulations = self.with_role("simulation")
        return next((c for c in simulations if c.of == measurement), None)

    def with_channel(self, channel: Channel, values: np.ndarray) -> "Recording":
        """The same recording with one more channel; `values` has shape (n,)."""
        samples = self.samples.assign(**{channel.name: values})
        return replace(self, samples=samples, channels=(*self.channels, channel))

    def cycles(self, wanted: Sequence[int]) -> "Recording":
        """Only the rows of the wanted cycles, in their order; RecordingError if one is empty."""
        present = set(self.samples["cycle"].unique())
        missing = sorted(set(wanted) - present)
        if missing:
            raise RecordingError(
                refusal(
                    "recording",
                    f"samples in cycles {sorted(wanted)}",
                    f"none in {missing} (it has {sorted(int(c) for c in present)})",
                    "Choose cycles that were recorded.",
                )
            )
        return replace(self, samples=self.samples[self.samples["cycle"].isin(list(wanted))])

    def require(self, samples: int, work: str) -> None:
        """Refuse work that needs more samples than there are."""
        if len(self.samples) < samples:
            raise RecordingError(
                refusal(
                    "recording",
                    f"at least {samples} samples for {work}",
                    f"{len(self.samples)}",
                    "Record more steps.",
                )
            )


def branch_of(command: np.ndarray) -> np.ndarray:
    """Direction of travel of each sample: +1 ascending (cw), -1 descending (ccw), shape (n,).

    Where the command stands still the last direction is held; the first samples take the first
    direction that follows. A command that never moves is 0 everywhere.
    """
    step = np.sign(np.diff(command, prepend=command[:1]))
    moving = np.flatnonzero(step)
    if moving.size == 0:
        return np.zeros(len(command), dtype=int)
    last = np.maximum.accumulate(np.where(step != 0, np.arange(len(step)), moving[0]))
    return step[last].astype(int)


def reversals_of(command: np.ndarray) -> np.ndarray:
    """Indices of the samples at which the command turns round, shape (r,).

    A turn counts once the command has come back by 1 % of its range, so that encoder noise is none.
    """
    threshold = REVERSAL_SHARE * float(np.ptp(command)) if len(command) else 0.0
    if threshold == 0.0:
        return np.zeros(0, dtype=int)
    turns: list[int] = []
    direction, extreme = 0, 0
    low = high = 0
    for i, value in enumerate(command):
        if direction == 0:
            low = i if value < command[low] else low
            high = i if value > command[high] else high
            if value - command[low] >= threshold:
                direction, extreme = 1, i
            elif command[high] - value >= threshold:
                direction, extreme = -1, i
        elif direction * (value - command[extreme]) >= 0:
            extreme = i
        elif direction * (command[extreme] - value) >= threshold:
            turns.append(extreme)
            direction, extreme = -direction, i
    return np.asarray(turns, dtype=int)


def cycles_from_reversals(command: np.ndarray) -> np.ndarray:
    """Cycle of each sample, from 0, shape (n,).

    A cycle ends where the command, after at least two reversals, passes its first value again
    in the direction in which it left it. Where a motion of several such ways comes again as a whole
    three times or more (a sum of sines, loops of several sizes by turns), all of it is one cycle:
    else every third would always be the same part of it.
    """
    turns = reversals_of(command)
    cycle = np.zeros(len(command), dtype=int)
    if len(turns) < 2:
        return cycle
    start = command[0]
    first_direction = 1.0 if command[turns[0]] > start else -1.0
    passed = first_direction * (command - start) >= -1e-9 * abs(np.ptp(command))
    where = np.append(np.flatnonzero(passed), len(command))
    begins = [0]
    while True:
        second = np.searchsorted(turns, begins[-1], side="right") + 1
        if second >= len(turns):
            break
        begin = int(where[np.searchsorted(where, turns[second])])
        if begin == len(command):
            break
        begins.append(begin)
    cycle[begins[:: ways_in_a_period(command, np.array(begins))][1:]] = 1
    return np.cumsum(cycle)


def ways_in_a_period(command: np.ndarray, begins: np.ndarray) -> int:
    """After how many ways there and back, which begin at some samples, a command comes again.

    1 where it never does, or not FEWEST_PERIODS times. A jump may come a sample early or late.
    """
    near = SAME_COMMAND * np.ptp(command)
    for ways in range(1, min(len(begins) // FEWEST_PERIODS, MOST_WAYS) + 1):
        period = int(np.median(begins[ways:] - begins[:-ways]))
        if np.quantile(np.abs(command[period:] - command[:-period]), MOST_ROWS) < near:
            return ways
    return 1


def with_context(samples: pd.DataFrame, channels: Sequence[Channel]) -> pd.DataFrame:
    """Add `cycle` and `step` where they are absent, from the command that leads."""
    samples = samples.copy()
    if "cycle" not in samples:
        leader = leading_command(
            *(
                {c.name: samples[c.name].to_numpy(float) for c in channels if c.role == role}
                for role in ("command", "measurement")
            )
        )
        samples["cycle"] = cycles_from_reversals(samples[leader].to_numpy(float)) if leader else 0
    if "step" not in samples:
        samples["step"] = samples.groupby("cycle").cumcount()
    rest = [c for c in samples.columns if c not in CONTEXT_COLUMNS]
    return samples[[*CONTEXT_COLUMNS, *rest]]


def load_recording(folder: Path) -> Recording:
    """Read and check a recording; a RecordingError names file, row, column and remedy."""
    head_file = folder / "recording.json"
    head = _read_head(head_file)
    channels = _read_channels(head_file, head)
    samples_file, samples = read_sample_table(folder)
    _require_columns(samples_file, list(samples.columns), channels)
    _check_samples(samples_file, samples, channels)
    return Recording(with_context(samples, channels), channels, str(head.get("source", "real")))


def save_recording(recording: Recording, folder: Path) -> None:
    """Write a recording so that a reader sees either the old or the new one, whole."""
    folder.mkdir(parents=True, exist_ok=True)
    write_head(recording.channels, recording.source, folder)
    write_atomically(folder / "samples.csv", recording.samples.to_csv(index=False))


def write_head(channels: Sequence[Channel], source: str, folder: Path) -> None:
    """Write `recording.json` alone: all that a recorder needs before its first row.

    OSError names the file where it can't be written.
    """
    head = {"schema": SCHEMA, "source": source, "channels": [c.as_json() for c in channels]}
    write_atomically(folder / "recording.json", json.dumps(head, indent=1))


def file_stem(name: str) -> str:
    """A channel's name as the beginning of a file's; another one where no file can be named so.

    Names such as `/joint/angle [0]` keep their letters, and get a mark that no other name has.
    """
    plain = re.sub(r"[^\w.-]", "_", name).lstrip(".")
    if plain == name and len(name.encode()) <= LONGEST_STEM:
        return name
    return f"{plain[: LONGEST_STEM // 4]}-{hashlib.sha256(name.encode()).hexdigest()[:8]}"


def _read_head(path: Path) -> dict[str, object]:
    if path.parent.is_file():
        raise RecordingError(
            refusal(str(path.parent), "a folder with recording.json and its samples", "a file",
                    "Name the folder, or import a file of your own: stages=[importing,...] "
                    "importing=one_axis importing.path=FILE (docs/importing.md).")
        )  # fmt: skip
    if not path.is_file():
        raise RecordingError(
            refusal(str(path), "a recording's head", "no such file", "Point `recording=` at a "
                    "folder with recording.json and samples.csv or samples.parquet.")
        )  # fmt: skip
    try:
        head = json.loads(path.read_text(encoding="utf-8-sig"))
    except (json.JSONDecodeError, UnicodeDecodeError, RecursionError) as error:
        raise RecordingError(
            refusal(str(path), "JSON", f"{error}", "Mend the file or write it anew.")
        ) from error
    if not isinstance(head, dict) or head.get("schema") != SCHEMA:
        found = head.get("schema") if isinstance(head, dict) else type(head).__name__
        raise RecordingError(
            refusal(str(path), f"schema {SCHEMA!r}", repr(found), "Convert it to this schema.")
        )
    return head


def _read_channels(path: Path, head: dict[str, object]) -> tuple[Channel, ...]:
    entries = head.get("channels")
    if not isinstance(entries, list) or not entries:
        raise RecordingError(
            refusal(str(path), "a list `channels`", repr(entries), "Name the channels.")
        )
    channels = []
    for number, entry in enumerate(entries):
        if not isinstance(entry, dict) or not all(
            isinstance(entry.get(key), str) for key in ("name", "role", "unit")
        ):
            raise RecordingError(
                refusal(f"{path}, channel {number}", "text for `name`, `role` and `unit`",
                        repr(entry), "Add what is missing.")
            )  # fmt: skip
        if not isinstance(entry.get("of"), str | None):
            raise RecordingError(
                refusal(f"{path}, channel {number}", "text for `of`", repr(entry["of"]),
                        "Name one measurement; each simulation has a channel of its own.")
            )  # fmt: skip
        channels.append(Channel(entry["name"], entry["role"], entry["unit"], entry.get("of")))
    check_channels(str(path), channels)
    return tuple(channels)


def check_channels(path: str, channels: Sequence[Channel]) -> None:
    """Refuse repeated names, unknown roles, units that contradict names, simulations of nothing."""
    repeated = [name for name, count in Counter(c.name for c in channels).items() if count > 1]
    if repeated:
        raise RecordingError(
            refusal(path, "each channel once", f"{repeated[0]!r} repeated", "Remove one.")
        )
    measurements = {c.name: c for c in channels if c.role == "measurement"}
    context = [c.name for c in channels if c.name in CONTEXT_COLUMNS and c.role != "other"]
    if context:
        raise RecordingError(
            refusal(f"{path}, channel {context[0]!r}", "a channel beside the context columns "
                    f"{', '.join(CONTEXT_COLUMNS)}", "one of them",
                    "Take it out: they need no entry.")
        )  # fmt: skip
    for channel in channels:
        where = f"{path}, channel {channel.name!r}"
        if channel.role not in ROLES:
            raise RecordingError(
                refusal(where, f"a role of {', '.join(ROLES)}", repr(channel.role), "Use one.")
            )
        if channel.role == "simulation":
            if channel.of not in measurements:
                raise RecordingError(
                    refusal(where, f"`of` to name a measurement ({', '.join(measurements)})",
                            repr(channel.of), "Name the measurement that it simulates.")
                )  # fmt: skip
            unit = measurements[channel.of].unit
            if channel.unit != unit:
                raise RecordingError(
                    refusal(where, f"the unit of {channel.of!r}, {unit!r}", repr(channel.unit),
                            "Convert the simulation to that unit.")
                )  # fmt: skip
        _check_unit(where, channel)


def _check_unit(where: str, channel: Channel) -> None:
    said = channel.unit.lower().replace("/", "_").replace("²", "2").replace("^", "").strip()
    name = channel.name.lower()
    end = max((u for u in NAME_UNITS if name.endswith("_" + u)), key=len, default="")
    alike, words = LETTERS.get(end, (frozenset({said}), ()))
    meant = said in alike or name.removesuffix("_" + end).endswith(words)
    if end and meant and said in NAME_UNITS and said != end:
        raise RecordingError(
            refusal(where, f"the unit of its name, {end!r}", repr(channel.unit),
                    "Make the name's ending and the unit agree.")
        )  # fmt: skip


def _require_columns(path: Path, columns: Sequence[str], channels: Sequence[Channel]) -> None:
    missing = [n for n in ("time_s", *(c.name for c in channels)) if n not in columns]
    if missing:
        raise RecordingError(
            refusal(str(path), f"a column {missing[0]!r}", f"columns {', '.join(columns)}",
                    "Add the column, or take the channel out of recording.json.")
        )  # fmt: skip


def _check_samples(path: Path, samples: pd.DataFrame, channels: Sequence[Channel]) -> None:
    first_row = 2 if path.suffix == ".csv" else 0
    may_be_empty = {c.name for c in channels if c.role != "command"}
    names = [n for n in CONTEXT_COLUMNS if n in samples] + [c.name for c in channels]
    for name in names:
        _check_kind(path, samples[name])
        numbers = pd.to_numeric(samples[name], errors="coerce")
        finite = np.isfinite(numbers.to_numpy(float))
        bad = ~finite & (samples[name].notna().to_numpy() if name in may_be_empty else True)
        if bad.any():
            row = int(np.flatnonzero(bad)[0])
            found = (
                "nothing"
                if pd.isna(samples[name].iloc[row])
                else repr(str(samples[name].iloc[row]))
            )
            raise RecordingError(
                refusal(f"{path}, row {row + first_row}, column {name!r}", "a number", found,
                        "Correct it" + (" or leave it empty." if name in may_be_empty else "."))
            )  # fmt: skip
        samples[name] = numbers
    check_time(path, samples["time_s"].to_numpy(float), first_row)
    for name in ("cycle", "step"):
        if name in samples:
            _check_whole(path, samples, name, first_row)


def _check_kind(path: Path, column: pd.Series) -> None:
    """Refuse a column that holds dates, or lists: they would become other numbers, or none."""
    lists = column.dtype == object and bool(column.map(pd.api.types.is_list_like).any())
    if lists or column.dtype.kind in "mM":
        raise RecordingError(
            refusal(f"{path}, column {column.name!r}", "numbers",
                    "lists" if lists else f"dates or times of day ({column.dtype})",
                    "Write one number in each row; a time in seconds.")
        )  # fmt: skip


def _check_whole(path: Path, samples: pd.DataFrame, name: str, first_row: int) -> None:
    values = samples[name].to_numpy(float)
    bad = np.flatnonzero((values < 0) | (values != np.round(values)) | (values > MOST_CYCLES))
    if bad.size:
        raise RecordingError(
            refusal(f"{path}, row {int(bad[0]) + first_row}, column {name!r}",
                    f"a whole number from 0 to {MOST_CYCLES:g}", f"{values[bad[0]]:g}",
                    "Correct it.")
        )  # fmt: skip
    samples[name] = values.astype(int)

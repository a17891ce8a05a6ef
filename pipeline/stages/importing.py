"""Importing: foreign tables and a mapping in, a recording and an account of what was done out."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass

import numpy as np
import pandas as pd

from pipeline.config_importing import (
    ImportedChannel,
    ImportedRows,
    ImportedTable,
    ImportingConfig,
)
from pipeline.errors import UsageError, refusal
from pipeline.foreign import resample
from pipeline.foreign.mapping import CONTEXT, check_mapping
from pipeline.foreign.table import ForeignFileError, ForeignTable
from pipeline.foreign.times import Clock, clock_of
from pipeline.foreign.units import factor
from pipeline.recording import Channel, Recording, with_context


@dataclass(frozen=True)
class TableAccount:
    """What became of a table: rows read and left out, how it was resampled, columns not taken."""

    where: str
    rows_read: int
    rows_left_out: int
    rows_moved: int
    resampled: str | None
    largest_gap_s: float
    rows_outside: int
    columns_left_out: list[str]


@dataclass(frozen=True)
class Account:
    """What was read, resampled, left out and counted."""

    tables: dict[str, TableAccount]
    rows: int
    rows_cut: int
    duration_s: float
    median_step_s: float
    largest_step_s: float
    empty: dict[str, int]
    filled: dict[str, int]

    def as_json(self) -> dict[str, object]:
        return asdict(self)


@dataclass(frozen=True)
class Imported:
    """A recording as it may be saved, and the account of how it came about.

    `frames`: by table, which of its images belongs to each row of the recording, shape (n,); -1
    where none does.
    """

    recording: Recording
    account: Account
    frames: Mapping[str, np.ndarray]


def assemble(config: ImportingConfig, tables: Mapping[str, ForeignTable]) -> Imported:
    """Make a recording of `tables` by the mapping; the first table's rows are its rows.

    UsageError where the mapping is wrong, ForeignFileError where the files are.
    """
    channels = check_mapping(config)
    values: dict[str, np.ndarray] = {}
    images: dict[str, np.ndarray] = {}
    accounts: dict[str, TableAccount] = {}
    base: Clock | None = None
    for name, mapping in config.tables.items():
        table = tables[name]
        own = {c: _channel_values(name, c, m, table) for c, m in mapping.channels.items()}
        length = _common_length(table, mapping, own)
        clock = clock_of(name, mapping, table, length, None if base is None else base.origin_ns)
        base = base or clock
        found = None if clock is base else _lookup(name, mapping, clock, base)
        for channel, column in own.items():
            ordered = column[clock.rows]
            values[channel] = ordered if found is None else found.of(ordered)
        if mapping.frames is not None:
            images[name] = clock.rows if found is None else found.rows(clock.rows)
        accounts[name] = _table_account(mapping, table, clock, found, length)
    assert base is not None
    samples = pd.DataFrame({"time_s": base.times_s, **values})
    chosen = _chosen(config.rows, base.times_s)
    kept = samples.iloc[chosen].reset_index(drop=True)
    filled = _fill_commands(config, kept)
    return Imported(
        Recording(with_context(kept, channels), channels, _source(config, accounts)),
        _account(accounts, samples, kept, channels, filled),
        {name: rows[chosen] for name, rows in images.items()},
    )


def _channel_values(
    table_name: str, name: str, mapping: ImportedChannel, table: ForeignTable
) -> np.ndarray:
    """A channel in its unit, shape (rows of the table,)."""
    where = f"importing.tables.{table_name}.channels.{name}"
    times = mapping.sign * factor(where, mapping.from_unit or mapping.unit, mapping.unit,
                                  mapping.scale)  # fmt: skip
    numbers = table.numbers(mapping.column or name).astype(float)
    infinite = np.flatnonzero(np.isinf(numbers))
    if infinite.size:
        raise ForeignFileError(
            refusal(f"{table.where}, {table.row_name(int(infinite[0]))}, column "
                    f"{mapping.column or name!r}", "a finite number", f"{numbers[infinite[0]]}",
                    "Correct it or leave it empty.")
        )  # fmt: skip
    return times * numbers + mapping.offset


def _common_length(
    table: ForeignTable, mapping: ImportedTable, own: Mapping[str, np.ndarray]
) -> int:
    lengths = {mapping.channels[c].column or c: len(column) for c, column in own.items()}
    if mapping.time.column is not None:
        lengths[mapping.time.column] = len(table.columns[table.find(mapping.time.column)])
    if len(set(lengths.values())) > 1 or not lengths or min(lengths.values()) == 0:
        found = ", ".join(f"{column} {length}" for column, length in lengths.items())
        raise ForeignFileError(
            refusal(table.where, "columns of one length, above 0", found or "no columns",
                    "Take columns that belong together; those of another rate are another table.")
        )  # fmt: skip
    return next(iter(lengths.values()))


def _lookup(name: str, mapping: ImportedTable, clock: Clock, base: Clock) -> resample.Lookup:
    assert mapping.resample is not None
    found = resample.lookup(clock.times_s, base.times_s, mapping.resample)
    if found.outside.all():
        raise UsageError(
            refusal(f"importing.tables.{name}.time",
                    f"samples between 0 and {base.times_s[-1]:.6g} s after the first table's first",
                    f"{clock.times_s[0]:.6g} to {clock.times_s[-1]:.6g} s",
                    "Correct the unit of its time, or `start_s` of its rate.")
        )  # fmt: skip
    return found


def _table_account(
    mapping: ImportedTable,
    table: ForeignTable,
    clock: Clock,
    found: resample.Lookup | None,
    length: int,
) -> TableAccount:
    taken = {table.find(m.column or c) for c, m in mapping.channels.items()}
    if mapping.time.column is not None:
        taken.add(table.find(mapping.time.column))
    steps = np.diff(clock.times_s)
    return TableAccount(
        where=table.where,
        rows_read=length,
        rows_left_out=clock.dropped,
        rows_moved=clock.moved,
        resampled=mapping.resample,
        largest_gap_s=float(steps.max(initial=0.0)),
        rows_outside=0 if found is None else int(found.outside.sum()),
        columns_left_out=[c for c in (*table.columns, *table.unusable) if c not in taken],
    )


def _chosen(rows: ImportedRows, times_s: np.ndarray) -> np.ndarray:
    """Indices of the rows that are kept, shape (k,)."""
    if rows.every < 1:
        raise UsageError(
            refusal("importing.rows.every", "a whole number from 1", f"{rows.every}", "Correct it.")
        )
    start = -np.inf if rows.start_s is None else rows.start_s
    end = np.inf if rows.end_s is None else rows.end_s
    kept = np.flatnonzero((times_s >= start) & (times_s < end))[:: rows.every]
    if kept.size == 0:
        raise UsageError(
            refusal("importing.rows", f"rows between 0 and {times_s[-1]:.6g} s",
                    f"none from {start:g} to {end:g} s", "Correct `start_s` and `end_s`.")
        )  # fmt: skip
    return kept


def _fill_commands(config: ImportingConfig, samples: pd.DataFrame) -> dict[str, int]:
    """Fill empty commands where that was asked for, refuse them elsewhere; how many of each."""
    filled = {}
    for name, table in config.tables.items():
        for channel, mapping in table.channels.items():
            if mapping.role not in ("command", CONTEXT):
                continue
            empty = int(samples[channel].isna().sum())
            if empty and mapping.fill is not None:
                samples[channel] = _filled(samples[["time_s", channel]], channel, mapping.fill)
                filled[channel] = empty
            still = np.flatnonzero(samples[channel].isna())
            if still.size:
                where = f"importing.tables.{name}.channels.{channel}"
                raise ForeignFileError(
                    refusal(f"{where}, at {samples['time_s'].iloc[still[0]]:.6g} s (row "
                            f"{still[0]} of the recording)", "a number in every row",
                            f"nothing in {still.size} rows", "Fill commands with "
                            "`fill: previous` or `linear`, or cut the rows with importing.rows.")
                )  # fmt: skip
    return filled


def _filled(samples: pd.DataFrame, channel: str, rule: str) -> pd.Series:
    """`previous` holds the last number; `linear` joins the numbers on both sides."""
    if rule == "previous":
        return samples[channel].ffill()
    have = samples.dropna()
    if have.empty:
        return samples[channel]
    found = resample.lookup(have["time_s"].to_numpy(), samples["time_s"].to_numpy(), rule)
    return samples[channel].fillna(pd.Series(found.of(have[channel].to_numpy())))


def _source(config: ImportingConfig, accounts: Mapping[str, TableAccount]) -> str:
    parts = [config.source]
    for account in accounts.values():
        file, comma, topic = account.where.partition(", topic ")
        name = file.rsplit("/", 1)[-1] + comma + topic
        parts.append(f"{account.resampled} resampling of {name}" if account.resampled else name)
    return "; ".join(parts)


def _account(
    tables: dict[str, TableAccount],
    samples: pd.DataFrame,
    kept: pd.DataFrame,
    channels: tuple[Channel, ...],
    filled: dict[str, int],
) -> Account:
    times = kept["time_s"].to_numpy()
    steps = np.diff(times)
    empty = {c.name: int(kept[c.name].isna().sum()) for c in channels}
    return Account(
        tables=tables,
        rows=len(kept),
        rows_cut=len(samples) - len(kept),
        duration_s=float(times[-1] - times[0]),
        median_step_s=float(np.median(steps)) if steps.size else 0.0,
        largest_step_s=float(steps.max(initial=0.0)),
        empty={name: count for name, count in empty.items() if count},
        filled=filled,
    )

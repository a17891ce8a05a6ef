"""A table's time: from a column or a rate, in seconds, in order or by a rule that was asked for."""

from dataclasses import dataclass

import numpy as np

from pipeline.config_importing import ImportedTable
from pipeline.errors import UsageError, refusal
from pipeline.foreign.table import ForeignFileError, ForeignTable
from pipeline.foreign.units import UNITS

RULES = ("drop", "sort")
DATE = "date"
NS = 10**9


@dataclass(frozen=True)
class Clock:
    """`rows` of a table in the order of their `times_s` (both (n,)); how many were left out.

    Times count from `origin_ns`, a whole number: an epoch in seconds has too few digits as float.
    """

    rows: np.ndarray
    times_s: np.ndarray
    origin_ns: int
    dropped: int
    moved: int


def clock_of(
    name: str,
    mapping: ImportedTable,
    table: ForeignTable,
    length: int,
    origin_ns: int | None,
) -> Clock:
    """The time of each row of a table; `origin_ns` is the first table's, None for itself."""
    where = f"importing.tables.{name}.time"
    if mapping.time.rate_hz is not None:
        if mapping.time.column is not None or not mapping.time.rate_hz > 0:
            raise UsageError(
                refusal(where, "either `column` or a `rate_hz` above 0",
                        f"column={mapping.time.column} rate_hz={mapping.time.rate_hz}",
                        "Leave one of them.")
            )  # fmt: skip
        times_s = mapping.time.start_s + np.arange(length) / mapping.time.rate_hz
        times_s = np.rint(times_s * NS) / NS  # so that it meets other clocks to the digit
        return Clock(np.arange(length), times_s, origin_ns or 0, 0, 0)
    if mapping.time.column is None:
        raise UsageError(
            refusal(where, "where the time comes from", "neither `column` nor `rate_hz`",
                    f"Name the column ({', '.join(list(table.columns)[:8])}, ...), or say the "
                    "rate at which the rows were taken: rate_hz.")
        )  # fmt: skip
    moments_ns = _whole_ns(where, mapping, table, length)
    rows, moved = _in_order(name, mapping, table, moments_ns)
    origin = int(moments_ns[rows[0]]) if origin_ns is None else origin_ns
    return Clock(rows, (moments_ns[rows] - origin) / NS, origin, length - len(rows), moved)


def _whole_ns(where: str, mapping: ImportedTable, table: ForeignTable, length: int) -> np.ndarray:
    assert mapping.time.column is not None
    kind, size = UNITS.get(mapping.time.unit, ("no", 1.0))
    if mapping.time.unit == DATE:
        values, size = table.dates_ns(mapping.time.column), 1e-9
    elif kind == "time":
        values = table.numbers(mapping.time.column)
    else:
        known = ", ".join(unit for unit, (what, _) in UNITS.items() if what == "time")
        raise UsageError(
            refusal(f"{where}.unit", f"a unit of time, {known}, or {DATE}",
                    repr(mapping.time.unit), "Choose one.")
        )  # fmt: skip
    if len(values) != length:
        raise _lengths(table, mapping.time.column, len(values), length)
    bad = np.flatnonzero(~np.isfinite(values))
    if bad.size:
        raise ForeignFileError(
            refusal(f"{table.where}, {table.row_name(int(bad[0]))}, column "
                    f"{mapping.time.column!r}", "a time", f"{values[bad[0]]}",
                    "Complete the time, or take the row out.")
        )  # fmt: skip
    if values.dtype.kind in "iu":
        return values.astype(np.int64) * round(size * NS)
    seconds = np.floor(values * size)
    return seconds.astype(np.int64) * NS + np.rint((values * size - seconds) * NS).astype(np.int64)


def _in_order(
    name: str, mapping: ImportedTable, table: ForeignTable, moments_ns: np.ndarray
) -> tuple[np.ndarray, int]:
    """Rows whose times rise, and how many of them stood elsewhere in the file."""
    rule = mapping.on_time_going_back
    if rule not in (None, *RULES):
        raise UsageError(
            refusal(f"importing.tables.{name}.on_time_going_back", f"one of {', '.join(RULES)}",
                    repr(rule), "Choose one.")
        )  # fmt: skip
    late = np.flatnonzero(np.diff(moments_ns) <= 0)
    rows = np.arange(len(moments_ns))
    if late.size == 0:
        return rows, 0
    if rule is None:
        row = int(late[0]) + 1
        raise ForeignFileError(
            refusal(f"{table.where}, {table.row_name(row)}, column {mapping.time.column!r}",
                    f"a time after {moments_ns[row - 1] / NS:.6f} s", f"{moments_ns[row] / NS:.6f} "
                    f"s ({late.size} such rows)", f"Mend the file, or say importing.tables.{name}."
                    "on_time_going_back=drop (leave such rows out) or sort.")
        )  # fmt: skip
    moved = 0
    if rule == "sort":
        rows = np.argsort(moments_ns, kind="stable")
        moved = int(np.count_nonzero(rows != np.arange(len(rows))))
    ordered = moments_ns[rows]
    before = np.maximum.accumulate(ordered)[:-1]
    return rows[np.concatenate(([True], ordered[1:] > before))], moved


def _lengths(table: ForeignTable, column: str, found: int, expected: int) -> ForeignFileError:
    return ForeignFileError(
        refusal(f"{table.where}, column {column!r}", f"{expected} rows as in the other columns",
                f"{found}", "Take columns of one length, or make a table for each of them.")
    )  # fmt: skip

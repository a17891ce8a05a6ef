"""Columns as a foreign file has them, and errors that say where in the file something is wrong."""

import datetime
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field

import numpy as np
import pandas as pd

from pipeline.errors import LoopgapError, UsageError, did_you_mean, refusal

LISTED = 30
TAKE_AS_DATE = "Take dates as time, with `time.unit: date`, or take another column."
MOMENTS = (datetime.date, datetime.time, datetime.timedelta)  # a datetime is a date


class ForeignFileError(LoopgapError):
    """A foreign file is not what its kind of file should be."""


def row_from_zero(row: int) -> str:
    """How a row is called where the format itself has no line numbers."""
    return f"row {row} (from 0)"


@contextmanager
def parsing(where: str, expected: str, remedy: str) -> Iterator[None]:
    """Refuse a file whose parser fails within: on broken files parsers raise whatever comes up."""
    try:
        yield
    except LoopgapError:
        raise
    except Exception as error:
        found = str(error).strip().rstrip(".") or type(error).__name__
        raise ForeignFileError(refusal(where, expected, found, remedy)) from error


@dataclass(frozen=True)
class ForeignTable:
    """Named columns of shape (n,); their lengths may differ where the file holds several arrays.

    `unusable` says of what else the file holds why it is no column; `repeated` are names that
    stand over several columns; `named` says how the columns came to their names, where that is a
    guess; `frames` gives a JPEG for each row, one after the other.
    """

    where: str
    columns: Mapping[str, np.ndarray]
    row_name: Callable[[int], str] = row_from_zero
    unusable: Mapping[str, str] = field(default_factory=dict)
    repeated: Sequence[str] = ()
    named: str = ""
    frames: Callable[[], Iterator[bytes]] | None = None

    def find(self, wanted: str) -> str:
        """The column of that name, or of that index from 0; UsageError lists those there are."""
        names = list(self.columns)
        if wanted in self.repeated:
            raise UsageError(
                refusal(self.where, f"one column {wanted!r}", "several of that name",
                        f"Give its index instead, from 0 to {len(names) - 1}.")
            )  # fmt: skip
        if wanted in self.columns:
            return wanted
        if wanted.isdigit() and int(wanted) < len(names):
            return names[int(wanted)]
        if wanted in self.unusable:
            raise UsageError(
                refusal(f"{self.where}, {wanted!r}", "a column of numbers", self.unusable[wanted],
                        "Name another column.")
            )  # fmt: skip
        others = [f"{name or 'all'} is {what}" for name, what in self.unusable.items()]
        found = f"columns {listed(names)}" + (f"; {listed(others)}" if others else "")
        remedy = f"{suggestion(wanted, names)}Name one of these in the mapping. {self.named}"
        raise UsageError(refusal(self.where, f"a column {wanted!r}", found, remedy.rstrip()))

    def numbers(self, wanted: str) -> np.ndarray:
        """A column as numbers, shape (n,), whole numbers left whole; empty cells are NaN."""
        name = self.find(wanted)
        values = self.columns[name]
        if values.dtype.kind in "fiu":
            return values
        if values.dtype.kind == "b":
            return values.astype(float)
        given = pd.Series(values)
        self._refuse_moments(name, values)
        numbers = pd.to_numeric(given, errors="coerce").to_numpy(dtype=float)
        bad = np.flatnonzero(np.isnan(numbers) & given.notna().to_numpy())
        if bad.size:
            raise ForeignFileError(
                refusal(f"{self.where}, {self.row_name(int(bad[0]))}, column {name!r}", "a number",
                        repr(str(values[bad[0]])), _remedy(str(values[bad[0]])))
            )  # fmt: skip
        return numbers

    def _refuse_moments(self, name: str, values: np.ndarray) -> None:
        """pandas would take dates for numbers, counted in a unit of its own."""
        dated = values.dtype.kind in "mM"
        found = [0] if dated else [k for k, v in enumerate(values) if isinstance(v, MOMENTS)]
        if found:
            raise UsageError(
                refusal(f"{self.where}, {self.row_name(found[0])}, column {name!r}", "a number",
                        f"the date or time {values[found[0]]}", TAKE_AS_DATE)
            )  # fmt: skip

    def dates_ns(self, wanted: str) -> np.ndarray:
        """A column of dates (ISO 8601, or as the file keeps them) in ns since 1970, UTC."""
        name = self.find(wanted)
        given = pd.Series(self.columns[name])
        dates = pd.to_datetime(given, utc=True, errors="coerce", format="ISO8601")
        bad = np.flatnonzero(dates.isna())
        if bad.size or given.dtype.kind in "fiu":
            row = int(bad[0]) if bad.size else 0
            raise ForeignFileError(
                refusal(f"{self.where}, {self.row_name(row)}, column {name!r}",
                        "a date such as 2026-05-01T12:00:00.25", repr(str(given.iloc[row])),
                        "Write dates so (ISO 8601), or give the unit of a number.")
            )  # fmt: skip
        return dates.dt.as_unit("ns").astype("int64").to_numpy()


def listed(names: Sequence[str]) -> str:
    """Names for a message; of very many only the first."""
    shown = ", ".join(names[:LISTED])
    more = len(names) - LISTED
    return (shown or "none") + (f" and {more} more" if more > 0 else "")


def suggestion(wanted: str, names: Sequence[str]) -> str:
    """A sentence on the name that was probably meant, the end of a dotted path too, or nothing."""
    ends = [name for name in names if name.lower().endswith(f".{wanted.lower().strip()}")]
    return did_you_mean(wanted, names) or did_you_mean(ends[0] if ends else "", ends)


def _remedy(text: str) -> str:
    if "," in text and text.replace(",", ".", 1).replace(".", "", 1).lstrip("+-").isdigit():
        return ("If that is a decimal comma, set `reading: {decimal: \",\"}` for the table in the "
                "mapping, or importing.tables.NAME.reading.decimal=\"','\" on the command line "
                "(csv and its kin, xlsx); elsewhere write numbers.")  # fmt: skip
    if not pd.isna(pd.to_datetime(text, errors="coerce", format="ISO8601")):
        return TAKE_AS_DATE
    return ("Correct it or leave it empty; rows of units or remarks are left out with "
            "`reading.skip_after_header`, `reading.skip_rows` or `reading.comment`.")  # fmt: skip

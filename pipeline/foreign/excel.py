"""Sheets of xlsx workbooks, as they were last calculated."""

from pathlib import Path

import numpy as np
from openpyxl import load_workbook

from pipeline.config_importing import ReadingConfig
from pipeline.errors import UsageError, refusal
from pipeline.foreign.headers import heads_columns, named_columns, names_from, repeated_names
from pipeline.foreign.table import ForeignFileError, ForeignTable, parsing


def read_xlsx(path: Path, reading: ReadingConfig) -> ForeignTable:
    """One sheet; rows are called as the spreadsheet calls them, from 1."""
    sheet, rows = _rows(path, reading, calculated=True)
    if any(value is None for _, row in rows for value in row):
        _refuse_uncalculated(path, reading, rows)
    if not rows:
        raise ForeignFileError(
            refusal(f"{path}, sheet {sheet!r}", "a table", "an empty sheet",
                    "Name another sheet: `reading.sheet`.")
        )  # fmt: skip
    head = ["" if value is None else str(value).strip() for value in rows[0][1]]
    with_header = heads_columns(head, reading.decimal) if reading.header is None else reading.header
    body = rows[(1 if with_header else 0) + reading.skip_after_header :]
    cells = np.empty((len(body), len(head)), dtype=object)
    for number, (_, row) in enumerate(body):
        cells[number] = [_pointed(value, reading.decimal) for value in row]
    numbers = [number for number, _ in body]
    names, repeated = named_columns(head, with_header), repeated_names(head, with_header)
    columns = {name: cells[:, i] for i, name in enumerate(names)}
    where = f"{path}, sheet {sheet!r}"
    named = names_from(f"row {rows[0][0]}", with_header)
    return ForeignTable(
        where, columns, lambda row: f"row {numbers[row]}", repeated=repeated, named=named
    )


def _pointed(value: object, decimal: str) -> object:
    """A cell; text with a decimal comma as other text is read, with a point."""
    return value.replace(decimal, ".") if isinstance(value, str) else value


def _rows(
    path: Path, reading: ReadingConfig, calculated: bool
) -> tuple[str, list[tuple[int, tuple[object, ...]]]]:
    """The sheet's name and its rows that are not blank, with their numbers, all equally wide."""
    with parsing(str(path), "a whole xlsx workbook", "Save or copy it anew."):
        book = load_workbook(path, read_only=True, data_only=calculated)
        name = _sheet(path, reading.sheet, book.sheetnames)
        rows = [
            (number, row)
            for number, row in enumerate(book[name].iter_rows(values_only=True), start=1)
            if number > reading.skip_rows and any(value is not None for value in row)
        ]
        book.close()
    width = max((len(row) for _, row in rows), default=0)
    return name, [(number, (*row, *[None] * (width - len(row)))) for number, row in rows]


def _sheet(path: Path, wanted: str | None, there: list[str]) -> str:
    if wanted in there:
        return str(wanted)
    if wanted is None and len(there) == 1:
        return there[0]
    raise UsageError(
        refusal(str(path), "the name of a sheet in `reading.sheet`", repr(wanted),
                f"Choose one of {', '.join(there)}.")
    )  # fmt: skip


def _refuse_uncalculated(
    path: Path, reading: ReadingConfig, rows: list[tuple[int, tuple[object, ...]]]
) -> None:
    """A formula that no spreadsheet program has calculated yet reads as an empty cell."""
    _, formulas = _rows(path, reading, calculated=False)
    values = dict(rows)
    for number, row in formulas:
        known = values.get(number, (None,) * len(row))
        for value, formula in zip(known, row, strict=False):
            if value is None and isinstance(formula, str) and formula.startswith("="):
                raise ForeignFileError(
                    refusal(f"{path}, row {number}", "calculated values", f"the formula {formula}",
                            "Open the workbook in a spreadsheet program and save it there.")
                )  # fmt: skip

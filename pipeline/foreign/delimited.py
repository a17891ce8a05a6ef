"""Text tables, csv, tsv and their kin: any separator, header or not, decimal point or comma."""

import csv
import io
from pathlib import Path

import numpy as np
import pandas as pd

from pipeline.config_importing import ReadingConfig
from pipeline.errors import UsageError, refusal
from pipeline.foreign.headers import heads_columns, named_columns, names_from, repeated_names
from pipeline.foreign.table import ForeignFileError, ForeignTable

SEPARATORS = ("\t", ";", "|", ",", " ")
LOOKED_AT = 50
BYTE_ORDER_MARKS = {
    b"\xef\xbb\xbf": "utf-8-sig",
    b"\xff\xfe": "utf-16",
    b"\xfe\xff": "utf-16",
}


def read_delimited(path: Path, reading: ReadingConfig) -> ForeignTable:
    """The whole table; columns without a header are called `0`, `1`, ..."""
    if reading.separator is not None and len(reading.separator) != 1:
        raise UsageError(
            refusal("reading.separator", "one character", repr(reading.separator),
                    "Give one (a tab is \"\\t\"), or null to have it found.")
        )  # fmt: skip
    try:
        return _table(path, reading)
    except csv.Error as error:
        raise ForeignFileError(
            refusal(str(path), "a table of text", str(error),
                    "Give `reading.separator` and `reading.skip_rows`, or export it anew.")
        ) from error  # fmt: skip


def _table(path: Path, reading: ReadingConfig) -> ForeignTable:
    text = _decoded(path, reading.encoding)
    kept = _kept_lines(text, reading)
    if not kept:
        raise ForeignFileError(
            refusal(str(path), "a table", "nothing in the file but blank or skipped lines",
                    "Export it again.")
        )  # fmt: skip
    lines = [line for _, line in kept]
    separator = reading.separator or _separator(lines[:LOOKED_AT])
    head = _cells(lines[0], separator)
    with_header = heads_columns(head, reading.decimal) if reading.header is None else reading.header
    names, repeated = named_columns(head, with_header), repeated_names(head, with_header)
    first = 1 + reading.skip_after_header if with_header else reading.skip_after_header
    body = kept[first:]
    _check_widths(path, body, separator, len(names))
    samples = _parse(path, [line for _, line in body], separator, len(names), reading.decimal)
    columns = {name: _numbered(samples[i], reading.decimal) for i, name in enumerate(names)}
    numbers = np.array([number for number, _ in body], dtype=int)
    named = f"Cells were parted at {separator!r} (`reading.separator`). "
    named += names_from(f"line {kept[0][0]}", with_header)
    return ForeignTable(
        str(path), columns, lambda row: f"line {numbers[row]}", repeated=repeated, named=named
    )


def _decoded(path: Path, encoding: str | None) -> str:
    try:
        data = path.read_bytes()
        marked = (name for mark, name in BYTE_ORDER_MARKS.items() if data.startswith(mark))
        return data.decode(next(marked, None) or encoding or "utf-8")
    except (OSError, LookupError, UnicodeError) as error:
        raise ForeignFileError(
            refusal(str(path), f"text in {encoding or 'UTF-8'}", str(error),
                    "Give its encoding, such as `reading.encoding: latin-1`, or export it anew.")
        ) from error  # fmt: skip


def _kept_lines(text: str, reading: ReadingConfig) -> list[tuple[int, str]]:
    """Lines with their number from 1, without those that are skipped, blank or a comment."""
    lines = list(enumerate(_lines(text), start=1))[reading.skip_rows :]
    mark = reading.comment
    return [
        (number, line)
        for number, line in lines
        if line.strip() and not (mark and line.lstrip().startswith(mark))
    ]


def _lines(text: str) -> list[str]:
    """Lines as any system ends them; `splitlines` would also part them at some printed signs."""
    return text.replace("\r\n", "\n").replace("\r", "\n").split("\n")


def _cells(line: str, separator: str) -> list[str]:
    cells = next(csv.reader([line], delimiter=separator, skipinitialspace=True))
    return [cell.strip() for cell in cells]


def _separator(lines: list[str]) -> str:
    """The first separator that gives all lines the same number of cells, more than one."""
    for separator in SEPARATORS:
        widths = {len(_cells(line.strip(), separator)) for line in lines}
        if len(widths) == 1 and widths.pop() > 1:
            return separator
    most = {s: sum(line.count(s) for line in lines) for s in SEPARATORS[:-1]}
    return max(most, key=lambda s: most[s]) if any(most.values()) else ","


def _check_widths(path: Path, body: list[tuple[int, str]], separator: str, width: int) -> None:
    """Each row has the header's number of cells; empty ones behind it do no harm."""
    if not body:
        raise ForeignFileError(
            refusal(str(path), "rows of samples", "a header alone", "Export it again.")
        )
    source = (line.strip(" ") if separator == " " else line for _, line in body)
    rows = csv.reader(source, delimiter=separator, skipinitialspace=True)
    for (number, _), cells in zip(body, rows, strict=False):
        if len(cells) != width and (len(cells) < width or any(c.strip() for c in cells[width:])):
            last = number == body[-1][0]
            raise ForeignFileError(
                refusal(f"{path}, line {number}", f"{width} cells", f"{len(cells)}",
                        "The file ends within a row: copy it anew, or delete that row." if last
                        else "Mend the row, or give `reading.separator`, `reading.skip_rows`, "
                        "`reading.comment`.")
            )  # fmt: skip


def _numbered(column: pd.Series, decimal: str) -> np.ndarray:
    """A column; where one cell is no number pandas leaves all as text, their decimals with them."""
    if decimal == "." or column.dtype.kind in "biuf":
        return column.to_numpy()
    pointed = column.map(lambda cell: str(cell).replace(decimal, "."), na_action="ignore")
    numbers = pd.to_numeric(pointed, errors="coerce")
    return column.astype(object).where(numbers.isna(), numbers).to_numpy()


def _parse(path: Path, lines: list[str], separator: str, width: int, decimal: str) -> pd.DataFrame:
    try:
        return pd.read_csv(
            io.StringIO("\n".join(line.strip(" ") for line in lines)),
            sep=r"\s+" if separator == " " else separator, header=None,
            usecols=list(range(width)), decimal=decimal, skipinitialspace=True,
            skip_blank_lines=False, low_memory=False,
        )  # fmt: skip
    except (ValueError, pd.errors.ParserError) as error:
        raise ForeignFileError(
            refusal(str(path), f"a table of {width} columns separated by {separator!r}",
                    str(error), "Give `reading.separator` and `reading.decimal`.")
        ) from error  # fmt: skip

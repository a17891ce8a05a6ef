"""JSON: a list of records, a mapping of columns, or JSON lines; nested values by dotted path."""

import json
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from pipeline.config_importing import ReadingConfig
from pipeline.errors import refusal
from pipeline.foreign.root import below
from pipeline.foreign.rows import Columns, leaves
from pipeline.foreign.table import ForeignFileError, ForeignTable, row_from_zero


def read_json(path: Path, reading: ReadingConfig) -> ForeignTable:
    """Records [{"q": [1, 2]}, ...] or columns {"q": [[1, 2], ...]}: both give `q.0` and `q.1`."""
    try:
        content = json.loads(path.read_text(encoding="utf-8-sig"))
    except (OSError, ValueError, RecursionError) as error:
        raise _refuse(str(path), error) from error
    found = below(str(path), content, reading.root)
    if isinstance(found, Mapping):
        return ForeignTable(str(path), _columns("", found))
    return _records(path, found if isinstance(found, list) else None)


def read_json_lines(path: Path, reading: ReadingConfig) -> ForeignTable:
    """One record a line; `reading.root` is within each."""
    records, numbers = [], []
    try:
        for number, line in enumerate(path.read_text(encoding="utf-8-sig").splitlines(), start=1):
            if line.strip():
                numbers.append(number)
                records.append(below(f"{path}, line {number}", json.loads(line), reading.root))
    except (OSError, ValueError, RecursionError) as error:
        raise _refuse(f"{path}, line {numbers[-1] if numbers else 1}", error) from error
    table = _records(path, records)
    return ForeignTable(str(path), table.columns, lambda row: f"line {numbers[row]}")


def _records(path: Path, records: list[object] | None) -> ForeignTable:
    if not records or not all(isinstance(record, (Mapping, list)) for record in records):
        raise ForeignFileError(
            refusal(str(path), "a list of records or a mapping of columns",
                    "neither" if records is None else "a list of other things or of nothing",
                    "Say with `reading.root` where in the file the samples are.")
        )  # fmt: skip
    columns = Columns()
    for record in records:
        columns.add(dict(leaves("", record)))
    return ForeignTable(str(path), columns.arrays(), row_from_zero)


def _columns(name: str, value: object) -> dict[str, np.ndarray]:
    """Each list in nested mappings is a column, a list of lists one for each place in them."""
    if isinstance(value, Mapping):
        found: dict[str, np.ndarray] = {}
        for key, part in value.items():
            found |= _columns(f"{name}.{key}" if name else str(key), part)
        return found
    columns = Columns()
    for part in value if isinstance(value, list) else [value]:
        columns.add(dict(leaves(name, part)))
    return columns.arrays()


def _refuse(where: str, error: Exception) -> ForeignFileError:
    return ForeignFileError(
        refusal(where, "JSON (in a .jsonl file: one record a line)", str(error),
                "Write or copy the file anew.")
    )  # fmt: skip

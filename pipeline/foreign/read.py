"""Which file a table of the mapping means, and which reader reads it."""

from collections.abc import Callable
from pathlib import Path

from pipeline.config_importing import ImportedTable, ReadingConfig
from pipeline.errors import UsageError, refusal
from pipeline.foreign.arrays import read_folder, read_npy, read_npz
from pipeline.foreign.bag import read_bag
from pipeline.foreign.delimited import read_delimited
from pipeline.foreign.excel import read_xlsx
from pipeline.foreign.matlab import read_mat
from pipeline.foreign.nested_json import read_json, read_json_lines
from pipeline.foreign.parquet import read_parquet
from pipeline.foreign.table import ForeignFileError, ForeignTable, listed

READERS: dict[str, Callable[[Path, ReadingConfig], ForeignTable]] = {
    **dict.fromkeys((".csv", ".tsv", ".txt", ".dat", ".log"), read_delimited),
    ".npy": read_npy,
    ".npz": read_npz,
    ".mat": read_mat,
    ".xlsx": read_xlsx,
    ".parquet": read_parquet,
    ".json": read_json,
    **dict.fromkeys((".jsonl", ".ndjson"), read_json_lines),
    **dict.fromkeys((".bag", ".db3", ".mcap"), read_bag),
}


def read_table(path: Path, name: str, mapping: ImportedTable) -> ForeignTable:
    """Read the file (or folder: a ROS 2 bag or npy files) that a table means; errors name it."""
    file = find_file(path, name, mapping.file)
    if file.is_dir():
        read = read_bag if (file / "metadata.yaml").is_file() else read_folder
        return read(file, mapping.reading)
    reader = READERS.get(file.suffix.lower())
    if reader is None:
        raise UsageError(
            refusal(str(file), f"one of {', '.join(READERS)}", f"{file.suffix or 'no ending'}",
                    "Export it as one of these, or rename it.")
        )  # fmt: skip
    if file.stat().st_size == 0:
        raise ForeignFileError(
            refusal(str(file), "samples", "an empty file", "Export or copy it anew.")
        )
    return reader(file, mapping.reading)


def find_file(path: Path, name: str, pattern: str | None) -> Path:
    """`path` itself, or the one file that `pattern` finds below it (beside it if it is a file)."""
    if not path.exists():
        raise UsageError(
            refusal(str(path), "a file or folder to import", "nothing", "Correct importing.path.")
        )
    if pattern is None:
        return path
    folder = path if path.is_dir() else path.parent
    found = sorted(folder.glob(pattern))
    if len(found) != 1:
        there = sorted(f.name for f in folder.iterdir())
        raise UsageError(
            refusal(str(folder), f"one file {pattern!r} (importing.tables.{name}.file)",
                    listed([str(f.relative_to(folder)) for f in found]) if found
                    else f"none; there are {listed(there)}",
                    "Correct the pattern or importing.path.")
        )  # fmt: skip
    return found[0]

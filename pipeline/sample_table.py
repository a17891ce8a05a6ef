"""A recording's table of samples as it lies on disk: one file, every row as wide as its head."""

import csv
from collections import Counter
from pathlib import Path

import numpy as np
import pandas as pd

from pipeline.errors import RecordingError, refusal

NAMES = ("samples.csv", "samples.parquet")
OTHER_SEPARATORS = (";", "\t", "|")


def read_sample_table(folder: Path) -> tuple[Path, pd.DataFrame]:
    """The file and its table, columns as in its head; RecordingError says file, row and remedy."""
    path = _file_of(folder)
    try:
        if path.suffix == ".parquet":
            samples = pd.read_parquet(path)
            columns = [str(c) for c in samples.columns]
        else:
            columns = _checked_head(path)
            samples = pd.read_csv(path, skipinitialspace=True, encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        raise RecordingError(
            refusal(str(path), "text in UTF-8", f"byte {error.object[error.start]:#04x} at "
                    f"{error.start}", "Save it as UTF-8, or import it: stages=[importing,...].")
        ) from error  # fmt: skip
    except (OSError, ValueError, csv.Error) as error:
        raise RecordingError(
            refusal(str(path), "a table of samples", f"{error}", "Write the file anew.")
        ) from error
    repeated = [name for name, count in Counter(columns).items() if count > 1]
    if repeated:
        raise RecordingError(
            refusal(str(path), "each column once", f"column {repeated[0]!r} repeated",
                    "Rename or remove one.")
        )  # fmt: skip
    samples.columns = pd.Index(columns)
    return path, samples


def check_time(path: Path, time_s: np.ndarray, first_row: int) -> None:
    """Refuse a time (n,) that goes back, and one that never goes on."""
    back = np.flatnonzero(np.diff(time_s) < 0)
    if back.size:
        row = int(back[0]) + 1
        raise RecordingError(
            refusal(f"{path}, row {row + first_row}, column 'time_s'",
                    f"a time not before {time_s[row - 1]:g} s", f"{time_s[row]:g} s",
                    "Sort the rows, or split the file where the clock was reset.")
        )  # fmt: skip
    if len(time_s) > 1 and time_s[0] == time_s[-1]:
        raise RecordingError(
            refusal(f"{path}, column 'time_s'", "a time that goes on",
                    f"{time_s[0]:g} s in all {len(time_s)} rows",
                    "Write when each sample was taken, in seconds.")
        )  # fmt: skip


def _file_of(folder: Path) -> Path:
    found = [folder / name for name in NAMES if (folder / name).is_file()]
    if len(found) != 1:
        raise RecordingError(
            refusal(str(folder), f"one of {' and '.join(NAMES)}",
                    " and ".join(f.name for f in found) or "neither", "Leave just one there.")
        )  # fmt: skip
    return found[0]


def _checked_head(path: Path) -> list[str]:
    """The columns of a csv, once every row is known to have a cell for each.

    Where rows are longer, pandas takes their first cells for an index and shifts the others; where
    they are shorter, it fills them.
    """
    with path.open(encoding="utf-8-sig", newline="") as file:
        rows = csv.reader(file, skipinitialspace=True)
        columns = [c.strip() for c in next(rows, [])]
        if not columns:
            raise RecordingError(
                refusal(str(path), "a first row with the columns' names", "an empty file",
                        "Write time_s, the channels' names and the samples.")
            )  # fmt: skip
        if len(columns) == 1 and any(s in columns[0] for s in OTHER_SEPARATORS):
            raise RecordingError(
                refusal(f"{path}, row 1", "columns parted by commas", f"{columns[0]!r}",
                        "Write it with commas, or import it: stages=[importing,...].")
            )  # fmt: skip
        for cells in rows:
            if cells and len(cells) != len(columns):
                raise RecordingError(
                    refusal(f"{path}, row {rows.line_num}", f"{len(columns)} cells, as in row 1",
                            f"{len(cells)}", "Mend the row: each column has a cell, maybe empty.")
                )  # fmt: skip
    return columns

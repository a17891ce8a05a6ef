"""npy and npz files, and folders of npy files: one table, a column for each column of an array."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from pipeline.config_importing import ReadingConfig
from pipeline.errors import refusal
from pipeline.foreign.flatten import flatten
from pipeline.foreign.table import ForeignFileError, ForeignTable, parsing


def read_npy(path: Path, _reading: ReadingConfig) -> ForeignTable:
    """One array: `0`, `1`, ... are its columns."""
    return _table(path, {"": _load(path)})


def read_npz(path: Path, _reading: ReadingConfig) -> ForeignTable:
    """Several arrays: `name` is a vector, `name.2` the third column of a matrix."""
    with _parsing(path), np.load(path, allow_pickle=False) as archive:
        return _table(path, {name: archive[name] for name in archive.files})


def read_folder(path: Path, _reading: ReadingConfig) -> ForeignTable:
    """All npy files of a folder as one table: `q_des.3` is the fourth column of q_des.npy."""
    files = sorted(path.glob("*.npy"))
    if not files:
        raise ForeignFileError(
            refusal(str(path), "npy files in the folder, or `file` in the mapping's table",
                    "no npy files", "Point `importing.path` at the file itself.")
        )  # fmt: skip
    return _table(path, {file.stem: _load(file) for file in files})


def _table(path: Path, arrays: dict[str, np.ndarray]) -> ForeignTable:
    columns: dict[str, np.ndarray] = {}
    rest: dict[str, str] = {}
    for name, array in arrays.items():
        flatten(name, array, columns, rest)
    return ForeignTable(str(path), columns, unusable=rest)


def _load(path: Path) -> np.ndarray:
    with _parsing(path), path.open("rb") as file:
        return np.lib.format.read_array(file, allow_pickle=False)


@contextmanager
def _parsing(path: Path) -> Iterator[None]:
    with parsing(str(path), "a whole NumPy file", "Save or copy it anew."):
        try:
            yield
        except ValueError as error:
            if "allow_pickle=False" not in str(error):
                raise
            raise ForeignFileError(
                refusal(str(path), "an array of numbers", "Python objects (a pickle), which could "
                        "run anything when loaded", "Save the numbers alone: np.save(FILE, "
                        "array.astype(float)).")
            ) from error  # fmt: skip

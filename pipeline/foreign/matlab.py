"""MATLAB's mat files, v5 (SciPy) and v7.3 (HDF5): variables and structs by dotted path."""

from pathlib import Path

import h5py
import numpy as np
from scipy.io import loadmat

from pipeline.config_importing import ReadingConfig
from pipeline.foreign.flatten import flatten
from pipeline.foreign.root import below
from pipeline.foreign.table import ForeignTable, parsing


def read_mat(path: Path, reading: ReadingConfig) -> ForeignTable:
    """All variables; `log.joint.2` is the third column of the field `joint` of the struct `log`."""
    with parsing(str(path), "a whole MATLAB file", "Save it anew (in MATLAB: save FILE -v7)."):
        content = _read_hdf5(path) if h5py.is_hdf5(path) else _read_v5(path)
    columns: dict[str, np.ndarray] = {}
    rest: dict[str, str] = {}
    flatten("", below(str(path), content, reading.root), columns, rest)
    return ForeignTable(str(path), columns, unusable=rest)


def _read_v5(path: Path) -> dict[str, object]:
    content = loadmat(path, simplify_cells=True)
    return {name: value for name, value in content.items() if not name.startswith("__")}


def _read_hdf5(path: Path) -> dict[str, object]:
    with h5py.File(path, "r") as file:
        return _group(file)


def _group(group: h5py.Group) -> dict[str, object]:
    """Datasets as arrays, turned: MATLAB stores the columns of a matrix as rows."""
    content: dict[str, object] = {}
    for name, item in group.items():
        if name.startswith("#"):
            continue
        if isinstance(item, h5py.Group):
            content[name] = _group(item)
        elif isinstance(item, h5py.Dataset):
            is_text = item.attrs.get("MATLAB_class") in (b"char", b"cell")
            is_empty = "MATLAB_empty" in item.attrs  # then it holds the sizes instead
            value = np.zeros(0) if is_empty else np.asarray(item[()]).T
            content[name] = "text or cells" if is_text else value
    return content

"""Nested arrays and structs as columns with dotted names."""

from collections.abc import Mapping

import numpy as np

MOST_COLUMNS = 10_000


def flatten(name: str, value: object, columns: dict[str, np.ndarray], rest: dict[str, str]) -> None:
    """Add `value` to `columns` (each of shape (n,)): a struct's field f is `name.f`, a matrix's
    column i `name.i`; what is none goes to `rest` with the reason."""
    if isinstance(value, Mapping):
        for key, part in value.items():
            flatten(f"{name}.{key}" if name else str(key), part, columns, rest)
        return
    array = np.asarray(value)
    if array.dtype.names:
        for key in array.dtype.names:
            flatten(f"{name}.{key}" if name else key, array[key], columns, rest)
    elif array.dtype.kind not in "fiub":
        rest[name] = _what(array)
    elif array.ndim <= 1 or array.size == max(array.shape):
        columns[name or "0"] = array.reshape(-1)
    elif array.ndim == 2 and array.shape[1] <= MOST_COLUMNS:
        for number in range(array.shape[1]):
            columns[f"{name}.{number}" if name else str(number)] = array[:, number]
    else:
        rest[name] = f"an array of shape {array.shape}"


def _what(array: np.ndarray) -> str:
    """What an array holds that is no real number."""
    if array.dtype.kind == "c":
        return "complex numbers"
    structs = array.ndim == 1 and all(isinstance(value, Mapping) for value in array)
    return f"an array of {len(array)} structs" if structs else "text or objects"

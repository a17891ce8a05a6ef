"""Rows of named values, whose names may change from row to row, as columns."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

LONGEST = 256


class Columns:
    """Columns that grow row by row; a name that a row lacks is None there."""

    def __init__(self) -> None:
        self._values: dict[str, list[object]] = {}
        self._rows = 0

    def add(self, row: Mapping[str, object]) -> None:
        """Add a row of values by column name."""
        for name, value in row.items():
            column = self._values.setdefault(name, [])
            column.extend([None] * (self._rows - len(column)))
            column.append(value)
        self._rows += 1

    def arrays(self) -> dict[str, np.ndarray]:
        """Each column with shape (rows,): numbers, or objects where some are none."""
        arrays = {}
        for name, column in self._values.items():
            whole = [*column, *[None] * (self._rows - len(column))]
            array = np.array(whole, dtype=object)
            is_number = all(isinstance(v, (int, float, np.number)) for v in whole)
            arrays[name] = np.array(whole) if is_number else array
        return arrays


def leaves(name: str, value: object) -> Iterator[tuple[str, object]]:
    """The single values within mappings and short sequences, each with its dotted path."""
    if isinstance(value, Mapping):
        for key, part in value.items():
            yield from leaves(f"{name}.{key}" if name else str(key), part)
    elif isinstance(value, (Sequence, np.ndarray)) and not isinstance(value, (str, bytes)):
        if len(value) <= LONGEST:
            for number, part in enumerate(value):
                yield from leaves(f"{name}.{number}" if name else str(number), part)
    else:
        yield name, value

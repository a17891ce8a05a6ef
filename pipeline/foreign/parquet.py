"""Parquet: columns, the fields of structs and the places of lists of one length."""

from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq

from pipeline.config_importing import ReadingConfig
from pipeline.foreign.table import ForeignTable, parsing


def read_parquet(path: Path, _reading: ReadingConfig) -> ForeignTable:
    """`state.x` is the field x of the struct `state`, `action.2` the third place of its lists."""
    columns: dict[str, np.ndarray] = {}
    rest: dict[str, str] = {}
    with parsing(str(path), "a whole Parquet file", "Write or copy it anew."):
        table = pq.read_table(path)
        while any(pa.types.is_struct(field.type) for field in table.schema):
            table = table.flatten()
        for name, column in zip(table.column_names, table.columns, strict=True):
            if not (pa.types.is_list(column.type) or pa.types.is_fixed_size_list(column.type)):
                columns[name] = column.to_pandas().to_numpy()
                continue
            lengths = pc.unique(pc.list_value_length(column)).to_pylist()
            if len(lengths) != 1 or not lengths[0]:
                rest[name] = "lists of different lengths"
                continue
            places = pc.list_flatten(column).to_numpy().reshape(-1, lengths[0])
            columns |= {f"{name}.{place}": places[:, place] for place in range(lengths[0])}
    return ForeignTable(str(path), columns, unusable=rest)

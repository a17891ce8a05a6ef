"""The cells of a table: the replicates that stand behind each, and why some are missing."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
import pandas as pd

from pipeline.errors import LoopgapError, UsageError, refusal
from pipeline.tracking.collection import Collection
from pipeline.tracking.jobs import DONE
from pipeline.tracking.paired_tests import holm, p_value
from pipeline.tracking.table_definition import Comparison, ShownMetric, TableDefinition

Key = tuple[object, ...]


@dataclass
class Cell:
    """One metric for one row and column: `values` by replicate, and what is missing and why."""

    row: Key
    column: Key
    metric: ShownMetric
    values: pd.Series
    missing: dict[str, int] = field(default_factory=dict)
    best: bool = False

    @property
    def n(self) -> int:
        """Replicates with a number."""
        return len(self.values)

    @property
    def mean(self) -> float:
        """Mean over the replicates; NaN if there are none."""
        return float(self.values.mean())

    @property
    def deviation(self) -> float:
        """Standard deviation of the replicates (n - 1); NaN below two."""
        return float(self.values.std(ddof=1))


@dataclass(frozen=True)
class Compared:
    """A cell against its baseline: difference over the n pairs, its p-value, the same by Holm."""

    cell: Cell
    baseline: str
    mean: float
    deviation: float
    n: int
    p: float
    p_holm: float


def cells_of(definition: TableDefinition, collection: Collection) -> list[Cell]:
    """Every cell in the order of metric, row, column.

    UsageError if the results lack a column that the definition names, or have another unit;
    LoopgapError if they have none of its metrics, or if several numbers stand for one replicate,
    as where a swept setting is named nowhere.
    """
    _check_columns(definition, collection)
    results = _chosen(collection.results, definition)
    results = results[results["metric"].isin([m.metric for m in definition.metrics])]
    if results.empty:
        raise LoopgapError(
            refusal("table", f"jobs with {', '.join(m.metric for m in definition.metrics)}",
                    "none", "Run what is missing: loopgap-collect says what.")
        )  # fmt: skip
    jobs = _chosen(collection.jobs, definition)
    cells = []
    for metric in definition.metrics:
        of_metric = results[results["metric"] == metric.metric]
        _check_unit(metric, of_metric)
        groups = dict(iter(of_metric.groupby(definition.keys, dropna=False, sort=False)))
        for key in _keys(definition, results if of_metric.empty else of_metric, jobs):
            part = groups.get(key, of_metric.iloc[:0])
            cells.append(_cell(definition, metric, key, part, jobs))
    _mark_best(definition, cells)
    return cells


def comparisons(definition: TableDefinition, cells: list[Cell]) -> list[Compared]:
    """Each cell that has a baseline beside it, against it; p-values corrected by Holm together."""
    compare = definition.compare
    if compare is None:
        return []
    place = definition.keys.index(compare.column)
    by_key = {(c.metric.metric, *c.row, *c.column): c for c in cells}
    baselines = {str(key[place + 1]): key[place + 1] for key in by_key}
    if compare.baseline not in baselines:
        raise UsageError(
            refusal("compare.baseline", f"one of {', '.join(baselines)}",
                    repr(compare.baseline), "Choose one.")
        )  # fmt: skip
    pairs = []
    for key, cell in by_key.items():
        beside = list(key)
        beside[place + 1] = baselines[compare.baseline]
        other = by_key.get(tuple(beside))
        if other is not None and other is not cell:
            pairs.append((cell, (cell.values - other.values).dropna().to_numpy(float)))
    return _tested(compare, pairs)


def _tested(compare: Comparison, pairs: list[tuple[Cell, np.ndarray]]) -> list[Compared]:
    p_values = [p_value(d, compare.test, compare.test_over_train) for _, d in pairs]
    return [
        Compared(
            cell,
            compare.baseline,
            float(d.mean()) if len(d) else float("nan"),
            float(d.std(ddof=1)) if len(d) > 1 else float("nan"),
            len(d),
            p,
            p_holm,
        )
        for (cell, d), p, p_holm in zip(pairs, p_values, holm(p_values), strict=True)
    ]


def _check_columns(definition: TableDefinition, collection: Collection) -> None:
    known = {*collection.results, *collection.jobs}
    for key in (*definition.keys, *definition.over, *definition.where):
        if key not in known:
            raise UsageError(
                refusal("table", f"one of the results' columns, {', '.join(sorted(known))}",
                        repr(key), "Name one of these in rows, columns, over and where.")
            )  # fmt: skip


def _check_unit(metric: ShownMetric, rows: pd.DataFrame) -> None:
    units = set(rows["unit"]) - {metric.unit}
    if units:
        raise UsageError(
            refusal(f"unit of {metric.metric}", repr(metric.unit), ", ".join(sorted(units)),
                    "Give the results' unit in the table.")
        )  # fmt: skip


def _chosen(table: pd.DataFrame, definition: TableDefinition) -> pd.DataFrame:
    """Rows that `where` allows; of the results those of single cycles only where they are named."""
    for key, value in definition.where.items():
        if key in table:
            allowed = value if isinstance(value, list) else [value]
            table = table[table[key].astype(str).isin([str(a) for a in allowed])]
    asked = {*definition.keys, *definition.over, *definition.where}
    if "cycle" in table:
        table = table[table["cycle"].notna() if "cycle" in asked else table["cycle"].isna()]
    return table


def _keys(definition: TableDefinition, rows: pd.DataFrame, jobs: pd.DataFrame) -> Iterator[Key]:
    """Rows and columns of a metric: what was planned, times what varies within a job."""
    keys = definition.keys
    swept = [key for key in keys if key in jobs]
    inside = [key for key in keys if key not in jobs]
    planned = jobs[swept].drop_duplicates() if swept else pd.DataFrame(index=[0])
    found = rows[inside].drop_duplicates() if inside else pd.DataFrame(index=[0])
    crossed = planned.merge(found, how="cross")[keys]
    for name in keys:
        order = list(dict.fromkeys(crossed[name]))
        crossed[name] = pd.Categorical(crossed[name], categories=order, ordered=True)
    yield from crossed.sort_values(keys).itertuples(index=False, name=None)


def _cell(
    definition: TableDefinition, metric: ShownMetric, key: Key, part: pd.DataFrame,
    jobs: pd.DataFrame,
) -> Cell:  # fmt: skip
    replicates = part.set_index(definition.over)["value"]
    if replicates.index.has_duplicates:
        raise LoopgapError(
            refusal(f"{metric.metric} of {', '.join(map(str, key))}",
                    f"one number for each {', '.join(definition.over)}", "several",
                    "Name the setting that differs in rows, columns, over or where.")
        )  # fmt: skip
    mine = jobs
    for name, value in zip(definition.keys, key, strict=True):
        if name in jobs:
            mine = mine[mine[name] == value]
    missing = Counter(
        status if not error else f"{status}: {error}"
        for status, error in zip(mine["status"], mine["error"], strict=True)
        if status != DONE
    )
    values = replicates.dropna().astype(float)
    if len(values) < len(replicates):
        missing["not measured"] = len(replicates) - len(values)
    split = len(definition.rows)
    return Cell(key[:split], key[split:], metric, values, dict(missing))


def _mark_best(definition: TableDefinition, cells: list[Cell]) -> None:
    among = definition.best_among or next(iter(definition.columns), None)
    if among is None:
        return
    place = definition.keys.index(among)
    rivals: dict[Key, list[Cell]] = {}
    for cell in cells:
        key = (*cell.row, *cell.column)
        rivals.setdefault((cell.metric.metric, *key[:place], *key[place + 1 :]), []).append(cell)
    for group in rivals.values():
        shown = [cell for cell in group if cell.n]
        best = group[0].metric.best
        if len(shown) < 2 or best == "none":
            continue
        means = [cell.mean for cell in shown]
        target = min(means) if best == "min" else max(means)
        for cell in shown:
            cell.best = cell.mean == target

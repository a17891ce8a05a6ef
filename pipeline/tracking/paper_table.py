"""Tables for a paper: from the jobs of a sweep to LaTeX, CSV, Markdown and numbers for the text.

Each file's head names the commit, the hashes of configurations and data, and that of the results;
`stale` makes them anew in memory and compares, so that no table can be older than its results.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from pipeline.errors import LoopgapError, refusal
from pipeline.recording import write_atomically
from pipeline.tracking.cells import Cell, Compared, cells_of, comparisons
from pipeline.tracking.collection import Collection
from pipeline.tracking.hashes import digest
from pipeline.tracking.paired_tests import WORDS
from pipeline.tracking.table_definition import ShownMetric, TableDefinition, read_definition
from pipeline.tracking.tables import ABSENT, latex_text, markdown

TABLES = "tables"
DIGIT_WORDS = ("Zero", "One", "Two", "Three", "Four", "Five", "Six", "Seven", "Eight", "Nine")
LISTED_HASHES = 8
LEAST_P = 0.0001


@dataclass(frozen=True)
class Shown:
    """All that the files of a table are made of."""

    definition: TableDefinition
    cells: list[Cell]
    compared: list[Compared]
    head: list[str]


def write_tables(
    sweep: Path, definition_file: Path, collection: Collection, mixed_commits: bool = False
) -> Path:
    """Write SWEEP/tables/NAME/ (table.tex, .md, .csv, comparisons.csv, numbers.tex); the folder."""
    folder = sweep / TABLES / definition_file.stem
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in table_files(definition_file, collection, mixed_commits).items():
        write_atomically(folder / name, text)
    return folder


def stale(
    sweep: Path, definition_file: Path, collection: Collection, mixed_commits: bool = False
) -> list[str]:
    """The files of a table that are missing or differ from what the results make of them now."""
    folder = sweep / TABLES / definition_file.stem
    texts = table_files(definition_file, collection, mixed_commits)
    return [
        name
        for name, text in texts.items()
        if not (folder / name).is_file() or (folder / name).read_bytes() != text.encode()
    ]


def table_files(
    definition_file: Path, collection: Collection, mixed_commits: bool = False
) -> dict[str, str]:
    """The files of a table by name; LoopgapError if its results are of several commits."""
    definition = read_definition(definition_file)
    cells = cells_of(definition, collection)
    _check_commits(collection, mixed_commits)
    shown = Shown(
        definition,
        cells,
        comparisons(definition, cells),
        _head(definition_file, collection),
    )
    files = {
        "table.tex": _latex(shown),
        "table.md": _markdown(shown),
        "table.csv": _csv(shown),
        "numbers.tex": _numbers(shown),
    }
    if shown.compared:
        files["comparisons.csv"] = _with_head(shown, "#", _comparison_table(shown).to_csv(
            index=False, lineterminator="\n"))  # fmt: skip
    return files


def _check_commits(collection: Collection, mixed: bool) -> None:
    commits = sorted(set(collection.results["commit"]))
    if len(commits) > 1 and not mixed:
        raise LoopgapError(
            refusal("table", "results of one commit", "; ".join(commits),
                    "Run the older jobs again, or take them together with --mixed-commits.")
        )  # fmt: skip


def _head(definition_file: Path, collection: Collection) -> list[str]:
    results = collection.results
    configurations = sorted(set(results["config_hash"]))
    return [
        f"table: {definition_file.name}, {digest(definition_file.read_text(encoding='utf-8'))}",
        *(f"commit: {commit}" for commit in sorted(set(results["commit"]))),
        f"configuration: {digest(configurations)} ({len(configurations)} jobs')",
        *_data_lines(sorted(set(results["data_hash"]))),
        f"results: {digest(results.to_csv(index=False))} "
        f"({results['job'].nunique()} of {len(collection.jobs)} jobs)",
    ]


def _data_lines(hashes: list[str]) -> Iterator[str]:
    if len(hashes) > LISTED_HASHES:
        yield f"data: {digest(hashes)} (of the hashes of {len(hashes)} recordings)"
    else:
        yield from (f"data: {value}" for value in hashes)


def _with_head(shown: Shown, comment: str, text: str) -> str:
    return "".join(f"{comment} {line}\n" for line in shown.head) + text


def _latex(shown: Shown) -> str:
    parts = [_tabular(_grid(shown, tex=True))]
    if shown.compared:
        parts += [f"% {_test_words(shown)}\n", _tabular(_comparison_table(shown, tex=True))]
    notes = [f"% {note}\n" for note in _notes(shown)]
    return _with_head(shown, "%", f"% {shown.definition.caption}\n" + "".join([*notes, *parts]))


def _tabular(table: pd.DataFrame) -> str:
    style = table.style.hide(axis="index")
    return style.to_latex(hrules=True, column_format="l" * len(table.columns))


def _markdown(shown: Shown) -> str:
    parts = [f"{shown.definition.caption}\n", markdown(_grid(shown))]
    if notes := _notes(shown):
        parts.append("\n".join(notes) + "\n")
    if shown.compared:
        parts += [f"{_test_words(shown)}\n", markdown(_comparison_table(shown))]
    head = "".join(f"<!-- {line} -->\n" for line in shown.head)
    return head + "\n" + "\n".join(parts)


def _csv(shown: Shown) -> str:
    """Full precision: a line for each cell."""
    definition = shown.definition
    rows = [
        dict(zip(definition.keys, (*cell.row, *cell.column), strict=True))
        | {
            "metric": cell.metric.metric,
            "unit": cell.metric.unit,
            "mean": cell.mean,
            "deviation": cell.deviation,
            "n": cell.n,
            "best": cell.best,
            "missing": _missing(cell),
        }
        for cell in shown.cells
    ]
    return _with_head(shown, "#", pd.DataFrame(rows).to_csv(index=False, lineterminator="\n"))


def _grid(shown: Shown, tex: bool = False) -> pd.DataFrame:
    """The table as it is read: a row for each row key, a column for each column and metric."""
    rows: dict[tuple[object, ...], dict[str, str]] = {}
    for cell in shown.cells:
        row = rows.setdefault(
            cell.row,
            {
                _said(name, tex): _said(value, tex)
                for name, value in zip(shown.definition.rows, cell.row, strict=True)
            },
        )
        title = " ".join([*map(str, cell.column), f"{cell.metric.label} [{cell.metric.unit}]"])
        row[_said(title, tex)] = _cell(cell, tex)
    return pd.DataFrame(list(rows.values())).fillna(_said(ABSENT, tex))


def _cell(cell: Cell, tex: bool) -> str:
    if cell.n == 0:
        return _said(f"{ABSENT} ({_missing(cell) or 'no job measured it'})", tex)
    mean = _number(cell.mean, cell.metric)
    if cell.best:
        mean = rf"\textbf{{{mean}}}" if tex else f"**{mean}**"
    deviation = _number(cell.deviation, cell.metric) if cell.n > 1 else ABSENT
    lacking = sum(cell.missing.values())
    of = f" of {cell.n + lacking}" if lacking else ""
    plus_minus, deviation = (r"$\pm$", _said(deviation, True)) if tex else ("±", deviation)
    return f"{mean} {plus_minus} {deviation} (n = {cell.n}{of})"


def _number(value: float, metric: ShownMetric) -> str:
    return f"{value:.{metric.digits}f}"


def _missing(cell: Cell) -> str:
    return "; ".join(
        f"{reason} ({count})" if count > 1 else reason for reason, count in cell.missing.items()
    )


def _notes(shown: Shown) -> list[str]:
    """What the numbers are, and every reason for a missing replicate."""
    notes = [f"Mean ± standard deviation over {', '.join(shown.definition.over)}; n numbers each."]
    reasons = dict.fromkeys(_missing(cell) for cell in shown.cells if cell.missing)
    notes += [f"Missing: {reason}." for reason in reasons]
    return notes


def _test_words(shown: Shown) -> str:
    compare = shown.definition.compare
    assert compare is not None
    ratio = (
        f", test over train {compare.test_over_train:g}" if compare.test == "corrected_t" else ""
    )
    return (
        f"Differences over the same {', '.join(shown.definition.over)}: {WORDS[compare.test]}"
        f"{ratio}, two-sided; p by Holm for {len(shown.compared)}."
    )


def _comparison_table(shown: Shown, tex: bool = False) -> pd.DataFrame:
    compare = shown.definition.compare
    assert compare is not None
    rows = []
    for one in shown.compared:
        cell = one.cell
        key = dict(zip(shown.definition.keys, (*cell.row, *cell.column), strict=True))
        of = key.pop(compare.column)
        digits = cell.metric.digits
        rows.append(
            {name: _said(value, tex) for name, value in key.items()}
            | {
                "metric": _said(f"{cell.metric.label} [{cell.metric.unit}]", tex),
                "difference": _said(f"{of} - {one.baseline}", tex),
                "mean": f"{one.mean:.{digits}f}",
                "deviation": f"{one.deviation:.{digits}f}" if one.n > 1 else _said(ABSENT, tex),
                "n": str(one.n),
                "p": _p(one.p, tex),
                "p by Holm": _p(one.p_holm, tex),
            }
        )
    return pd.DataFrame(rows)


def _p(value: float, tex: bool) -> str:
    if pd.isna(value):
        return _said(ABSENT, tex)
    if value < LEAST_P:
        return f"$<$ {LEAST_P:g}" if tex else f"< {LEAST_P:g}"
    return f"{value:.2g}"


def _said(value: object, tex: bool) -> str:
    return latex_text(str(value)) if tex else str(value)


def _numbers(shown: Shown) -> str:
    """A macro for each mean, deviation, n and p-value, for running text."""
    macros: dict[str, str] = {}
    for cell in shown.cells:
        if cell.n == 0:
            continue
        name = _macro(shown.definition, cell)
        digits = cell.metric.digits
        _add(macros, name, f"{cell.mean:.{digits}f}")
        _add(macros, f"{name}Deviation", f"{cell.deviation:.{digits}f}" if cell.n > 1 else "--")
        _add(macros, f"{name}N", str(cell.n))
    for one in shown.compared:
        name = f"{_macro(shown.definition, one.cell)}Versus{_letters(one.baseline)}"
        _add(macros, f"{name}P", _p(one.p_holm, tex=True))
    lines = [f"\\newcommand{{\\{name}}}{{{value}}}\n" for name, value in macros.items()]
    return _with_head(shown, "%", "".join(lines))


def _macro(definition: TableDefinition, cell: Cell) -> str:
    parts = []
    for key, value in zip(definition.keys, (*cell.row, *cell.column), strict=True):
        number = isinstance(value, int | float)
        parts.append(f"{_letters(key.split('.')[-1]) if number else ''}{_letters(value)}")
    return "".join([*parts, _letters(cell.metric.metric)])


def _letters(text: object) -> str:
    """Text as a part of a macro's name, which may have letters only."""
    words = re.findall(r"[a-zA-Z]+|\d", str(text))
    return "".join(DIGIT_WORDS[int(w)] if w.isdigit() else w[0].upper() + w[1:] for w in words)


def _add(macros: dict[str, str], name: str, value: str) -> None:
    if name in macros:
        raise LoopgapError(
            refusal("numbers.tex", "a name of its own for each number", f"\\{name} twice",
                    "Make the table's rows and columns differ in letters or digits.")
        )  # fmt: skip
    macros[name] = value

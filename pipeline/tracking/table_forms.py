"""The forms of a table: LaTeX, Markdown and CSV of its cells and of its paired tests."""

from dataclasses import dataclass

import pandas as pd

from pipeline.tracking.cells import Cell, Compared
from pipeline.tracking.paired_tests import WORDS
from pipeline.tracking.table_definition import ShownMetric, TableDefinition
from pipeline.tracking.tables import ABSENT, latex_text, markdown

LEAST_P = 0.0001


@dataclass(frozen=True)
class Shown:
    """All that the files of a table are made of."""

    definition: TableDefinition
    cells: list[Cell]
    compared: list[Compared]
    head: list[str]


def with_head(shown: Shown, comment: str, text: str) -> str:
    """The text below the head, whose lines begin as a comment does."""
    return "".join(f"{comment} {line}\n" for line in shown.head) + text


def table_latex(shown: Shown) -> str:
    """The cells as a tabular with booktabs rules; caption and notes are comments above it."""
    notes = [shown.definition.caption, *_notes(shown)]
    return _tabular(shown, notes, _grid(shown, tex=True))


def comparisons_latex(shown: Shown) -> str:
    """The paired tests as a tabular of its own."""
    return _tabular(shown, [_test_words(shown)], _comparison_table(shown, tex=True))


def _tabular(shown: Shown, notes: list[str], table: pd.DataFrame) -> str:
    style = table.style.hide(axis="index")
    text = style.to_latex(hrules=True, column_format="l" * len(table.columns))
    return with_head(shown, "%", "".join(f"% {note}\n" for note in notes) + text)


def table_markdown(shown: Shown) -> str:
    """Cells, notes and paired tests for reading; the head in comments that are not shown."""
    parts = [f"{shown.definition.caption}\n", markdown(_grid(shown))]
    if notes := _notes(shown):
        parts.append("\n".join(notes) + "\n")
    if shown.compared:
        parts += [f"{_test_words(shown)}\n", markdown(_comparison_table(shown))]
    head = "".join(f"<!-- {line} -->\n" for line in shown.head)
    return head + "\n" + "\n".join(parts)


def table_csv(shown: Shown) -> str:
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
    return with_head(shown, "#", pd.DataFrame(rows).to_csv(index=False, lineterminator="\n"))


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
                "mean": difference(one.mean, digits, tex),
                "deviation": difference(one.deviation, digits, tex)
                if one.n > 1
                else _said(ABSENT, tex),
                "n": str(one.n),
                "p": p_value(one.p, tex),
                "p by Holm": p_value(one.p_holm, tex),
            }
        )
    return pd.DataFrame(rows)


def comparisons_csv(shown: Shown) -> str:
    """The paired tests as they are read, a line each."""
    table = _comparison_table(shown).to_csv(index=False, lineterminator="\n")
    return with_head(shown, "#", table)


def difference(value: float, digits: int, tex: bool) -> str:
    """A number with so many digits, or as many as it takes not to be called zero."""
    text = f"{value:.{digits}f}"
    if float(text) == 0.0:
        text = f"{abs(value):.{digits}f}" if value == 0.0 else f"{value:.1e}"
    return text.replace("-", "$-$") if tex else text


def p_value(value: float, tex: bool) -> str:
    """A p-value in two digits, or that it is below the least one told."""
    if pd.isna(value):
        return _said(ABSENT, tex)
    if value < LEAST_P:
        return f"$<$ {LEAST_P:g}" if tex else f"< {LEAST_P:g}"
    return f"{value:.2g}"


def _said(value: object, tex: bool) -> str:
    return latex_text(str(value)) if tex else str(value)

"""Tables on disk and on the terminal: CSV, Markdown, LaTeX (booktabs) and plain text."""

from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from pipeline.atomically import write_atomically
from pipeline.number_words import LARGEST
from pipeline.tracking.wide_latex import too_wide, wrapped

METRIC_COLUMNS = ("axis", "method", "cycle", "metric", "value", "unit", "n")
DECIMALS = {"[deg]": 3, "[um]": 1, "[%]": 1}
LATEX_SPECIAL = str.maketrans(
    {"%": r"\%", "_": r"\_", "&": r"\&", "#": r"\#", "$": r"\$", "{": r"\{", "}": r"\}",
     "\\": r"\textbackslash{}", "~": r"\textasciitilde{}", "^": r"\textasciicircum{}"}
)  # fmt: skip
ABSENT = "–"


def write_table(table: pd.DataFrame, folder: Path, name: str) -> list[Path]:
    """Write `name`.csv (full precision), .md and .tex (rounded by unit); the paths written."""
    folder.mkdir(parents=True, exist_ok=True)
    texts = {
        "csv": table.to_csv(index=False, lineterminator="\n"),
        "md": markdown(table),
        "tex": latex(table),
    }
    paths = []
    for suffix, text in texts.items():
        path = folder / f"{name}.{suffix}"
        write_atomically(path, text)
        paths.append(path)
    return paths


def markdown(table: pd.DataFrame) -> str:
    """The table in Markdown, numbers to the right."""
    cells = _cells(table)
    right = _numeric(table)
    widths = _widths(table, cells)
    rule = [
        "-" * (width - 1) + ":" if number else "-" * width
        for width, number in zip(widths, right, strict=True)
    ]
    rows = [_escaped(table.columns), rule, *(_escaped(row) for row in cells)]
    return "".join(f"| {' | '.join(_aligned(row, widths, right))} |\n" for row in rows)


def plain(table: pd.DataFrame) -> str:
    """The table for a terminal, columns two blanks apart."""
    cells = _cells(table)
    right = _numeric(table)
    widths = _widths(table, cells)
    rows = [[str(c) for c in table.columns], ["-" * width for width in widths], *cells]
    return "\n".join("  ".join(_aligned(row, widths, right)).rstrip() for row in rows)


def latex(table: pd.DataFrame) -> str:
    """The table as a LaTeX tabular with booktabs rules; `um` becomes a micrometre.

    Texts are wrapped where the table would be wider than a line.
    """
    right = _numeric(table)
    rows = [[str(c) for c in table.columns], *_cells(table)]
    columns, *body = [[latex_text(cell) for cell in row] for row in rows]
    if too_wide(rows):
        return wrapped(rows, [columns, *body], right)
    styler = pd.DataFrame(body, columns=columns).style.hide(axis="index")
    return styler.to_latex(hrules=True, column_format="".join("r" if r else "l" for r in right))


def latex_text(text: str) -> str:
    """Text as LaTeX sets it as it is."""
    escaped = text.translate(LATEX_SPECIAL).replace(ABSENT, "--")
    return escaped.replace("[um]", r"[$\mu$m]").replace("±", r"$\pm$")


def _cells(table: pd.DataFrame) -> list[list[str]]:
    columns = [[_cell(str(name), value) for value in table[name]] for name in table.columns]
    return [list(row) for row in zip(*columns, strict=True)]


def _cell(column: str, value: object) -> str:
    if value is None or (isinstance(value, float) and pd.isna(value)):
        return ABSENT
    if isinstance(value, float):
        places = next((n for unit, n in DECIMALS.items() if column.endswith(unit)), None)
        if places is None and 9999.5 <= abs(value) < LARGEST:
            return f"{value:.0f}"
        return f"{value:.4g}" if places is None else f"{value:.{places}f}"
    return str(value)


def _numeric(table: pd.DataFrame) -> list[bool]:
    return [pd.api.types.is_numeric_dtype(dtype) for dtype in table.dtypes]


def _widths(table: pd.DataFrame, cells: Sequence[Sequence[str]]) -> list[int]:
    rows = [_escaped(table.columns), *(_escaped(row) for row in cells)]
    return [max(3, *(len(row[i]) for row in rows)) for i in range(len(table.columns))]


def _aligned(row: Sequence[str], widths: Sequence[int], right: Sequence[bool]) -> list[str]:
    return [
        cell.rjust(width) if number else cell.ljust(width)
        for cell, width, number in zip(row, widths, right, strict=True)
    ]


def _escaped(row: Sequence[object] | pd.Index) -> list[str]:
    return [str(cell).replace("|", r"\|").replace("\n", " ") for cell in row]

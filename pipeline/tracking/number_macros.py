"""numbers.tex: a macro for each number of a table, for running text."""

import re

from pipeline.errors import LoopgapError, refusal
from pipeline.tracking.cells import Cell
from pipeline.tracking.table_definition import TableDefinition
from pipeline.tracking.table_forms import Shown, p_value, with_head

DIGIT_WORDS = ("Zero", "One", "Two", "Three", "Four", "Five", "Six", "Seven", "Eight", "Nine")


def number_macros(shown: Shown) -> str:
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
        _add(macros, f"{name}P", p_value(one.p_holm, tex=True))
    lines = [f"\\newcommand{{\\{name}}}{{{value}}}\n" for name, value in macros.items()]
    return with_head(shown, "%", "".join(lines))


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

"""A LaTeX table wider than a line: texts wrapped, heads stacked, what is longest below its row."""

import re
from collections.abc import Sequence

LINE = 78
GAP = 1.4
SHORT = 10
LONG = 40
PIECE = re.compile(r"[^\s_/+-]+[_/+-]*|[_/+-]+")
END = r" \tabularnewline"
BREAK = r"\allowbreak{}"

Rows = Sequence[Sequence[str]]


def too_wide(rows: Rows) -> bool:
    """Whether rows of plain text, the head first, are wider than a line of small print."""
    return sum(_natural(rows)) + GAP * len(rows[0]) > LINE


def wrapped(plain: Rows, tex: Rows, right: Sequence[bool]) -> str:
    """A tabular as wide as the line, with booktabs rules and no other package.

    plain, tex: the rows, head first, as text and as LaTeX sets it; right: columns of numbers. A
    text longer than LONG signs stands below its row, under the head of its column; another text
    column gets room for its longest piece, and of what is left its share by its length.
    """
    natural = _natural(plain)
    longest = max(range(len(natural)), key=lambda i: natural[i])
    below = longest if natural[longest] > LONG and len(natural) > 1 else None
    kept = [i for i in range(len(natural)) if i != below]
    widths = _widths([[row[i] for i in kept] for row in plain], [right[i] for i in kept])
    lines = []
    for number, row in enumerate(tex):
        cells = [
            _stacked(row[i], right[i]) if number == 0 and width is None
            else row[i] if width is None else _paragraph(row[i])
            for i, width in zip(kept, widths, strict=True)
        ]  # fmt: skip
        lines.append(" & ".join(cells) + END)
        if below is not None:
            room = rf"\multicolumn{{{len(kept) - 1}}}{{p{{0.92\linewidth}}@{{}}}}"
            lines.append(rf"& {room}{{{_paragraph(row[below])}}}{END}")
        lines.append(r"\midrule" if number == 0 else r"\addlinespace")
    layout = "".join(
        (r"r" if right[i] else "l") if width is None else rf"p{{{width:.3f}\linewidth}}"
        for i, width in zip(kept, widths, strict=True)
    )
    begin = [r"{\footnotesize\setlength{\tabcolsep}{3pt}%",
             rf"\begin{{tabular}}{{@{{}}{layout}@{{}}}}", r"\toprule"]  # fmt: skip
    return "\n".join([*begin, *lines[:-1], r"\bottomrule", r"\end{tabular}}", ""])


def _widths(plain: Rows, right: Sequence[bool]) -> list[float | None]:
    """Share of the line that each wrapped column takes; None: as wide as its texts are."""
    natural = _natural(plain)
    wraps = [not r and n > SHORT for r, n in zip(right, natural, strict=True)]
    least = [
        max(_longest_piece(cell) if wrap or n == 0 else len(cell) for n, cell in enumerate(column))
        for column, wrap in zip(zip(*plain, strict=True), wraps, strict=True)
    ]
    more = [n - m if wrap else 0 for n, m, wrap in zip(natural, least, wraps, strict=True)]
    spare = max(0.0, LINE - GAP * len(natural) - sum(least)) / max(1, sum(more))
    return [
        (m + spare * x) / LINE if wrap else None
        for m, x, wrap in zip(least, more, wraps, strict=True)
    ]


def _natural(rows: Rows) -> list[int]:
    return [max(map(len, column)) for column in zip(*rows, strict=True)]


def _longest_piece(text: str) -> int:
    return max((len(piece) for piece in PIECE.findall(text)), default=0)


def _paragraph(tex: str) -> str:
    broken = re.sub(r"(\\_|/)", lambda found: found.group(1) + BREAK, tex)
    return rf"\raggedright {broken}"


def _stacked(tex: str, right: bool) -> str:
    lines = tex.replace(" ", r"\\")
    return rf"\shortstack[{'r' if right else 'l'}]{{{lines}}}"

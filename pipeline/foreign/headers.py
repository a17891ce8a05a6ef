"""Names of columns: from a header row where there is one, else their index."""

from collections import Counter


def heads_columns(cells: list[str], decimal: str) -> bool:
    """Whether a first row names columns: something in it is no number."""
    return any(cell and not _is_number(cell.replace(decimal, ".")) for cell in cells)


def named_columns(cells: list[str], with_header: bool) -> list[str]:
    """A different name for each column; one without a name takes its index."""
    seen: Counter[str] = Counter()
    names = []
    for name in _given(cells, with_header):
        seen[name] += 1
        names.append(name if seen[name] == 1 else f"{name} ({seen[name]})")
    return names


def repeated_names(cells: list[str], with_header: bool) -> list[str]:
    """Names that stand over several columns."""
    return [name for name, count in Counter(_given(cells, with_header)).items() if count > 1]


def names_from(first: str, with_header: bool) -> str:
    """Where a table's names came from, and the setting for it; `first` is its first row."""
    if with_header:
        return f"Names were taken from {first} (`reading.skip_rows`)."
    return f"No names were found in {first}: columns are called by their index from 0."


def _given(cells: list[str], with_header: bool) -> list[str]:
    return [cell if with_header and cell else str(i) for i, cell in enumerate(cells)]


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True

"""Tables for a paper: from the jobs of a sweep to LaTeX, CSV, Markdown and numbers for the text.

Each file's head names the commit, the hashes of configurations and data, and that of the results;
`stale` makes them anew in memory and compares, so that no table can be older than its results.
"""

from collections.abc import Iterator
from pathlib import Path

from pipeline.atomically import write_atomically
from pipeline.errors import LoopgapError, refusal
from pipeline.tracking.cells import cells_of, comparisons
from pipeline.tracking.collection import Collection
from pipeline.tracking.hashes import digest
from pipeline.tracking.number_macros import number_macros
from pipeline.tracking.table_definition import read_definition
from pipeline.tracking.table_forms import (
    Shown,
    comparisons_csv,
    comparisons_latex,
    table_csv,
    table_latex,
    table_markdown,
)

TABLES = "tables"
LISTED_HASHES = 8


def write_tables(
    sweep: Path, definition_file: Path, collection: Collection, mixed_commits: bool = False
) -> Path:
    """Write SWEEP/tables/NAME/ (table.*, comparisons.*, numbers.tex); the folder."""
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
        "table.tex": table_latex(shown),
        "table.md": table_markdown(shown),
        "table.csv": table_csv(shown),
        "numbers.tex": number_macros(shown),
    }
    if shown.compared:
        files["comparisons.tex"] = comparisons_latex(shown)
        files["comparisons.csv"] = comparisons_csv(shown)
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

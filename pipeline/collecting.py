"""The command `loopgap-collect`, and what happens of itself at the end of a sweep."""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from pipeline.config import CONF
from pipeline.errors import LoopgapError, UsageError, refusal
from pipeline.tracking.collection import DIAGNOSES, REPEAT_FILE, Collection, collect, gather
from pipeline.tracking.paper_table import stale, write_tables
from pipeline.tracking.planned import read_plan

LISTED_JOBS = 5
RESULTS_CSV = "results.csv"


def main() -> None:
    """Exit 0 if the sweep is complete and nothing is stale, 1 if not, 2 on misuse."""
    sys.exit(run(sys.argv[1:]))


def run(arguments: Sequence[str]) -> int:
    """Do what the arguments ask for; the exit status."""
    asked = _parser().parse_args(arguments)
    try:
        tables = [_definition(name) for name in asked.table] or _tables_of(asked.folder)
        if asked.check:
            return _check(asked.folder, tables, asked.mixed_commits)
        return conclude(asked.folder, tables, asked.mixed_commits)
    except LoopgapError as error:
        print(f"loopgap-collect: {error}", file=sys.stderr)
        return error.exit_status
    except OSError as error:
        print(f"loopgap-collect: {error}", file=sys.stderr)
        return LoopgapError.exit_status


def conclude(sweep: Path, tables: Sequence[Path] | None = None, mixed_commits: bool = False) -> int:
    """Collect a sweep, write its tables and say what is there; 0 if every job is.

    Without `tables`, those called like the sweep's experiment (or that and `_` and more).
    """
    collection = collect(sweep)
    print(f"\nresults of all jobs: {sweep / 'results.md'}")
    if len(collection.diagnoses):
        print(f"what their simulations left out: {sweep / DIAGNOSES}.md")
    _say_incomplete(collection, sweep)
    status = 1 if len(collection.incomplete) else 0
    for definition in _tables_of(sweep) if tables is None else tables:
        if collection.results.empty:
            continue
        folder = write_tables(sweep, definition, collection, mixed_commits)
        print(f"table: {folder / 'table.md'}")
    return status


def _check(sweep: Path, tables: Sequence[Path], mixed_commits: bool) -> int:
    collection = gather(sweep)
    old = []
    written = sweep / RESULTS_CSV
    if not written.is_file() or written.read_text() != collection.results.to_csv(index=False):
        old.append(RESULTS_CSV)
    said = sweep / f"{DIAGNOSES}.csv"
    if said.is_file() or len(collection.diagnoses):
        now = collection.diagnoses.to_csv(index=False)
        if not said.is_file() or said.read_text() != now:
            old.append(said.name)
    for definition in tables:
        files = stale(sweep, definition, collection, mixed_commits)
        old += [f"{definition.stem}/{name}" for name in files]
    for name in old:
        print(f"{name} is not what the jobs' results make of it", file=sys.stderr)
    _say_incomplete(collection, sweep)
    return 1 if old or len(collection.incomplete) else 0


def _say_incomplete(collection: Collection, sweep: Path) -> None:
    lacking = collection.incomplete
    if lacking.empty:
        return
    print(f"{len(lacking)} of {len(collection.jobs)} jobs are missing:", file=sys.stderr)
    for job in lacking.head(LISTED_JOBS).to_dict("records"):
        said = f"{job['status']}: {job['error']}" if job["error"] else job["status"]
        print(f"  job {job['job']} {said}\n    {job['command']}", file=sys.stderr)
    if len(lacking) > LISTED_JOBS:
        print(f"  and {len(lacking) - LISTED_JOBS} more, in results.md", file=sys.stderr)
    print(f"just these again: sh {sweep / REPEAT_FILE}", file=sys.stderr)


def _tables_of(sweep: Path) -> list[Path]:
    plan = read_plan(sweep)
    name = "" if plan is None else plan.experiment
    folder = CONF / "table"
    return sorted([*folder.glob(f"{name}.yaml"), *folder.glob(f"{name}_*.yaml")]) if name else []


def _definition(name: str) -> Path:
    """A file, or the name of one in conf/table."""
    known = CONF / "table" / f"{name}.yaml"
    file = known if known.is_file() else Path(name)
    if not file.is_file():
        names = ", ".join(sorted(f.stem for f in (CONF / "table").glob("*.yaml")))
        raise UsageError(refusal("--table", f"a file, or one of {names}", repr(name),
                                 "Choose one, or name a file."))  # fmt: skip
    return file


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="loopgap-collect",
        description="Gather the jobs of a sweep into results.parquet, and make its tables.",
    )
    parser.add_argument("folder", type=Path, metavar="DIR", help="the folder that a sweep wrote")
    parser.add_argument(
        "--table",
        action="append",
        default=[],
        metavar="NAME|FILE",
        help="a table of conf/table, or a file; without it, those named like the experiment",
    )
    parser.add_argument(
        "--check",
        action="store_true",
        help="write nothing; fail where a table is not what the results make of it",
    )
    parser.add_argument(
        "--mixed-commits",
        action="store_true",
        help="let results of different commits stand in one table",
    )
    return parser


if __name__ == "__main__":
    main()

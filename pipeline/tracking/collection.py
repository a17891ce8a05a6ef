"""Collection: one long table over the jobs of a sweep, and how to come by what it lacks."""

import shlex
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path

import pandas as pd

from pipeline.atomically import write_atomically
from pipeline.tracking.diagnoses import Entry, how_much, overview, parameters
from pipeline.tracking.jobs import DONE, ORIGIN, Job, read_jobs
from pipeline.tracking.planned import config_options, override, settings
from pipeline.tracking.tables import METRIC_COLUMNS, markdown, write_table

RESULTS_FILE = "results.parquet"
REPEAT_FILE = "repeat.sh"
DIAGNOSES, PARAMETERS_FILE = "diagnoses", "parameters.csv"
INCOMPLETE_COLUMNS = ["job", "status", "error", "command"]
NOTHING = "None of these jobs measured anything that a table could show: look into their folders."
SUMMARY_KEYS = ["axis", "method", "metric", "unit"]


@dataclass(frozen=True)
class Collection:
    """All that a sweep left.

    `results`: a row for each job and number: job, its overrides, `ORIGIN`, what a stage varied
    within a job, then `METRIC_COLUMNS`. `jobs`: job, status, error and the overrides of every job
    that was planned or found. `incomplete`: job, status, error and the command that repeats it.
    `diagnoses`: a row for each job and diagnosed measurement: job, the overrides that differ among
    jobs, verdict, what was left out and by how much, errors, noise. `parameters`: of those, a row
    for each parameter of each name.
    """

    results: pd.DataFrame
    jobs: pd.DataFrame
    incomplete: pd.DataFrame
    diagnoses: pd.DataFrame
    parameters: pd.DataFrame


def collect(sweep: Path) -> Collection:
    """Gather the jobs below `sweep` and write what was found there, whole each time.

    results.parquet and results.csv (`Collection.results`), results.md (what is there and what is
    not), diagnoses.csv, .md and .tex and parameters.csv (where jobs diagnosed something), repeat.sh
    (the commands that repeat the incomplete jobs; none if there are none). A job
    that failed, was never started or lost its numbers is listed, never dropped. UsageError if there
    is no job at all.
    """
    collection = gather(sweep)
    write_atomically(sweep / RESULTS_FILE, parquet(collection.results))
    write_atomically(sweep / "results.csv", collection.results.to_csv(index=False))
    write_atomically(sweep / "results.md", _report(collection))
    if len(collection.diagnoses):
        write_table(collection.diagnoses, sweep, DIAGNOSES)
        write_atomically(sweep / PARAMETERS_FILE, collection.parameters.to_csv(index=False))
    if len(collection.incomplete):
        write_atomically(sweep / REPEAT_FILE, _repeat(sweep, collection.incomplete))
    else:
        (sweep / REPEAT_FILE).unlink(missing_ok=True)
    return collection


def gather(sweep: Path) -> Collection:
    """What `collect` finds, without writing anything."""
    jobs = read_jobs(sweep)
    overrides = _typed(pd.DataFrame([settings(job.overrides) for job in jobs]))
    heads = pd.DataFrame([(j.name, j.status, j.error) for j in jobs],
                         columns=["job", "status", "error"]).join(overrides)  # fmt: skip
    done = [job for job in jobs if job.status == DONE]
    options = config_options(sweep)
    incomplete = [
        (job.name, job.status, job.error, command(job, sweep, options))
        for job in jobs
        if job not in done
    ]
    return Collection(
        _stacked(done, heads.drop(columns=["status", "error"])),
        heads,
        pd.DataFrame(incomplete, columns=INCOMPLETE_COLUMNS),
        _diagnosed(done, heads, _with_how_much),
        _diagnosed(done, heads, parameters),
    )


def command(job: Job, sweep: Path, options: Sequence[str] = ()) -> str:
    """The command that runs just this job, into its place in the sweep."""
    place = (sweep / job.name).resolve()
    return shlex.join(["loopgap", *options, *job.overrides, override("hydra.run.dir", place)])


def parquet(table: pd.DataFrame) -> bytes:
    """The table as a parquet file, the same bytes for the same table."""
    buffer = BytesIO()
    table.to_parquet(buffer, index=False)
    return buffer.getvalue()


def _typed(overrides: pd.DataFrame) -> pd.DataFrame:
    """Columns of text as numbers where all that is there are numbers."""
    for key in overrides:
        numbers = pd.to_numeric(overrides[key], errors="coerce")
        if numbers.notna().equals(overrides[key].notna()):
            overrides[key] = numbers.convert_dtypes()
    return overrides[sorted(overrides.columns)]


def _stacked(done: list[Job], heads: pd.DataFrame) -> pd.DataFrame:
    tables = [
        job.metrics.assign(job=job.name, **job.origin) for job in done if job.metrics is not None
    ]
    head = [*heads.columns, *ORIGIN]
    if not tables:
        return pd.DataFrame(columns=[*head, *METRIC_COLUMNS])
    stacked = pd.concat(tables, ignore_index=True).merge(heads, on="job", how="left")
    varied = [c for c in stacked if c not in {*head, *METRIC_COLUMNS}]
    return stacked[[*head, *varied, *METRIC_COLUMNS]]


def _diagnosed(
    done: list[Job], heads: pd.DataFrame, tell: Callable[[Sequence[Entry]], pd.DataFrame]
) -> pd.DataFrame:
    """What is told of each job's diagnoses, behind its name and what differs between jobs."""
    differing = [c for c in heads if c == "job" or heads[c].nunique(dropna=False) > 1]
    differing = [c for c in differing if c not in ("status", "error")]
    tables = [tell(job.diagnoses).assign(job=job.name) for job in done if job.diagnoses]
    if not any(len(table) for table in tables):
        return pd.DataFrame(columns=differing)
    return heads[differing].merge(pd.concat(tables, ignore_index=True), on="job")


def _with_how_much(entries: Sequence[Entry]) -> pd.DataFrame:
    table = overview(entries)
    place = list(table.columns).index("left out") + 1
    table.insert(place, "how much (95 %)", [how_much(entry) for entry in entries])
    return table


def _report(collection: Collection) -> str:
    jobs, lacking = len(collection.jobs), collection.incomplete
    parts = [f"# {jobs - len(lacking)} of {jobs} jobs\n"]
    if len(lacking):
        parts.append(
            f"## Incomplete\n\n{markdown(lacking)}\n`sh {REPEAT_FILE}` repeats just these.\n"
        )
    if len(collection.diagnoses):
        parts.append(f"## What was left out\n\n{markdown(_verdicts(collection.diagnoses))}")
        parts.append(f"Each: {DIAGNOSES}.md, .csv, .tex; every parameter: {PARAMETERS_FILE}.\n")
    elif collection.results.empty:
        parts.append(f"{NOTHING}\n")
    if len(collection.results):
        parts.append(f"## All jobs together\n\n{markdown(_summary(collection.results))}")
    parts.append(f"Every number: {RESULTS_FILE}, results.csv ({len(collection.results)} rows).\n")
    return "\n".join(parts)


def _summary(results: pd.DataFrame) -> pd.DataFrame:
    """Mean, deviation and number over the jobs of each number that is not of a single cycle."""
    varied = [c for c in results.columns[list(results.columns).index(ORIGIN[-1]) + 1 :]
              if c not in METRIC_COLUMNS]  # fmt: skip
    pooled = results[results["cycle"].isna()]
    groups = pooled.groupby([*varied, *SUMMARY_KEYS], sort=False, dropna=False)["value"]
    return groups.agg(mean="mean", deviation="std", n="count").reset_index()


def _verdicts(diagnoses: pd.DataFrame) -> pd.DataFrame:
    """How many jobs say the same of a measurement, the most frequent first."""
    said = diagnoses.groupby(["measurement", "verdict", "left out"], sort=False).size()
    counted = said.sort_values(ascending=False, kind="stable").rename("jobs").reset_index()
    return counted.sort_values("measurement", kind="stable")


def _repeat(sweep: Path, incomplete: pd.DataFrame) -> str:
    lines = [
        "#!/bin/sh",
        "# Repeats the jobs that are missing; begin it where the sweep was begun.",
        *incomplete["command"],
        shlex.join(["loopgap-collect", str(sweep.resolve())]),
    ]
    return "\n".join(lines) + "\n"

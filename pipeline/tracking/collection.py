"""Collection: one table over the jobs of a sweep.

A job's folder holds `job.json`, {"overrides": {key: value}, "status": "done" | "failed",
"error": text or null}, and `evaluation/metrics.csv` when it got that far.
"""

import json
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from pipeline.errors import UsageError, refusal
from pipeline.recording import write_atomically
from pipeline.tracking.tables import METRIC_COLUMNS, markdown

JOB_FILE = "job.json"
INCOMPLETE_COLUMNS = ["job", "status", "error"]
HEADLINES = {"model_rmse": "model", "landing_rmse_camera": "landing"}
METRICS_FILE = Path("evaluation") / "metrics.csv"


@dataclass(frozen=True)
class Collection:
    """`results`: job, overrides, then `METRIC_COLUMNS`; `incomplete`: job, status, error."""

    results: pd.DataFrame
    incomplete: pd.DataFrame

    def results_wide(self) -> pd.DataFrame:
        """The root-mean-square errors alone, a row for each job and axis, a column for each."""
        chosen = self.results[self.results["metric"].isin(HEADLINES)]
        keys = [c for c in self.results.columns if c not in METRIC_COLUMNS] + ["axis"]
        rows: dict[tuple[object, ...], dict[str, object]] = {}
        for record in chosen.to_dict("records"):
            row = rows.setdefault(tuple(record[k] for k in keys), {k: record[k] for k in keys})
            row[f"{record['method']} {HEADLINES[record['metric']]} [deg]"] = record["value"]
        return pd.DataFrame(list(rows.values()), columns=None if rows else keys)


def collect(sweep: Path) -> Collection:
    """Gather the jobs below `sweep` and write results.csv, results.md there, whole each time.

    Jobs stand in natural order of their folders (2 before 10). A job that failed, or that left no
    metrics, is listed as incomplete instead of dropped. UsageError if there is no job at all.
    """
    jobs = _job_folders(sweep)
    tables: list[pd.DataFrame] = []
    incomplete: list[dict[str, str]] = []
    for folder in jobs:
        name = folder.relative_to(sweep).as_posix()
        job, problem = _read_job(folder)
        metrics, lack = _read_metrics(folder) if problem is None else (None, problem)
        if metrics is None:
            status = str(job.get("status", "unreadable"))
            incomplete.append({"job": name, "status": status, "error": str(lack)})
            continue
        overrides = job.get("overrides") or {}
        columns = {"job": name} | {key: _shown(overrides[key]) for key in sorted(overrides)}
        tables.append(pd.DataFrame([columns] * len(metrics)).join(metrics))
    collection = Collection(_stacked(tables), pd.DataFrame(incomplete, columns=INCOMPLETE_COLUMNS))
    write_atomically(sweep / "results.csv", collection.results.to_csv(index=False))
    write_atomically(sweep / "results.md", _report(collection, len(jobs)))
    return collection


def _job_folders(sweep: Path) -> list[Path]:
    folders = [path.parent for path in sweep.glob(f"*/{JOB_FILE}")] if sweep.is_dir() else []
    if not folders:
        raise UsageError(
            refusal(str(sweep), f"job folders with {JOB_FILE}", "none",
                    "Name the folder that a multirun wrote.")
        )  # fmt: skip
    return sorted(folders, key=lambda folder: _natural(folder.relative_to(sweep).as_posix()))


def _natural(name: str) -> list[tuple[int, str]]:
    parts = re.findall(r"\d+|\D+", name)
    return [(int(part), "") if part.isdigit() else (-1, part) for part in parts]


def _read_job(folder: Path) -> tuple[dict[str, Any], str | None]:
    try:
        job = json.loads((folder / JOB_FILE).read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        return {}, f"{JOB_FILE}: {error}"
    if not isinstance(job, dict):
        return {}, f"{JOB_FILE}: expected an object; found {type(job).__name__}"
    if job.get("status") != "done":
        return job, str(job.get("error") or "did not finish")
    return job, None


def _read_metrics(folder: Path) -> tuple[pd.DataFrame | None, str | None]:
    try:
        metrics = pd.read_csv(folder / METRICS_FILE)
    except (OSError, ValueError) as error:
        return None, f"{METRICS_FILE.as_posix()}: {error}"
    missing = [name for name in METRIC_COLUMNS if name not in metrics]
    if missing:
        return None, f"{METRICS_FILE.as_posix()}: no column {', '.join(missing)}"
    return metrics[list(METRIC_COLUMNS)], None


def _shown(value: object) -> object:
    return value if isinstance(value, str | int | float | bool) else json.dumps(value)


def _stacked(tables: list[pd.DataFrame]) -> pd.DataFrame:
    if not tables:
        return pd.DataFrame(columns=["job", *METRIC_COLUMNS])
    stacked = pd.concat(tables, ignore_index=True)
    overrides = sorted(set(stacked.columns) - {"job", *METRIC_COLUMNS})
    return stacked[["job", *overrides, *METRIC_COLUMNS]]


def _report(collection: Collection, jobs: int) -> str:
    done = jobs - len(collection.incomplete)
    parts = [f"# {done} of {jobs} jobs\n"]
    if len(collection.incomplete):
        parts.append(f"## Incomplete\n\n{markdown(collection.incomplete)}")
    parts.append(f"## Root-mean-square errors\n\n{markdown(collection.results_wide())}")
    parts.append(f"## All results\n\n{markdown(collection.results)}")
    return "\n".join(parts)

"""The jobs of a sweep: what was planned, how each ended, and the metrics that it left.

A job's folder holds `job.json` (overrides, status, error), `provenance.json`, a `metrics.csv` in
the folder of each stage that measures something, and `diagnosis.json` where one was made. Only what
lies in the sweep's folder is read, so it may be moved.
"""

import json
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pandas as pd

from pipeline.errors import UsageError, refusal
from pipeline.tracking.diagnoses import DIAGNOSIS_FILE, Entry, read_diagnoses
from pipeline.tracking.hashes import digest
from pipeline.tracking.planned import UNREADABLE, Plan, read_plan, read_yaml, settings
from pipeline.tracking.tables import METRIC_COLUMNS

JOB_FILE = "job.json"
METRICS_FILE = "metrics.csv"
DONE, FAILED, UNFINISHED, NEVER = "done", "failed", "unfinished", "never started"
UNKNOWN = "unknown"
NO_SAY = (("cache", "use"), ("cache", "folder"), ("vision", "workers"))  # in no result
ORIGIN = ("commit", "config_hash", "data_hash")


@dataclass(frozen=True)
class Job:
    """One job: its folder's name, its overrides as given, how it ended, and what it left.

    `origin` has `ORIGIN`'s commit and hashes; `metrics` is there if the job is done, None where
    none of its stages measures anything. `diagnoses`: its entries of diagnosis.json.
    """

    name: str
    overrides: list[str]
    status: str
    error: str = ""
    origin: dict[str, str] = field(default_factory=dict)
    metrics: pd.DataFrame | None = None
    diagnoses: Sequence[Entry] = ()


def read_jobs(sweep: Path) -> list[Job]:
    """Every job of a sweep, planned or found, in natural order; UsageError if there is none."""
    plan = read_plan(sweep)
    found = [file.parent.name for file in sweep.glob(f"*/{JOB_FILE}")] if sweep.is_dir() else []
    planned = [] if plan is None else [str(number) for number in range(len(plan.jobs))]
    names = sorted({*planned, *found}, key=_natural)
    if not names:
        raise UsageError(
            refusal(str(sweep), f"job folders with {JOB_FILE}", "none",
                    "Name the folder that a multirun wrote.")
        )  # fmt: skip
    return [_read(sweep / name, plan) for name in names]


def _read(folder: Path, plan: Plan | None) -> Job:
    name = folder.name
    wanted = _planned(name, plan)
    if not (folder / JOB_FILE).is_file():
        return Job(name, wanted or [], NEVER)
    try:
        job = json.loads((folder / JOB_FILE).read_text(encoding="utf-8"))
        given = {str(key): str(value) for key, value in (job.get("overrides") or {}).items()}
    except (OSError, ValueError, AttributeError) as error:
        return Job(name, wanted or [], "unreadable", f"{JOB_FILE}: {error}")
    overrides = wanted or _given(folder, given)
    if plan is not None and (wanted is None or settings(wanted) != given):
        return Job(name, overrides, "not of this sweep",
                   "its folder holds a job with other overrides than this sweep's")  # fmt: skip
    status = str(job.get("status"))
    if status == FAILED:
        return Job(name, overrides, FAILED, str(job.get("error") or "no error was noted"))
    if status != DONE:
        return Job(name, overrides, UNFINISHED, f"it was {status} when it was last heard of")
    try:
        metrics = _metrics(folder, set(given))
        diagnoses = _diagnoses(folder)
        return Job(name, overrides, DONE, "", _origin(folder), metrics, diagnoses)
    except (*UNREADABLE, KeyError, TypeError) as error:
        return Job(name, overrides, "no results", str(error))


def _planned(name: str, plan: Plan | None) -> list[str] | None:
    if plan is None or not name.isdecimal() or int(name) >= len(plan.jobs):
        return None
    return plan.jobs[int(name)]


def _given(folder: Path, settings_given: dict[str, str]) -> list[str]:
    """The overrides as Hydra noted them (with `+` and `~`), else as the job did."""
    try:
        noted = read_yaml(folder / ".hydra" / "overrides.yaml")
    except UNREADABLE:
        noted = None
    if isinstance(noted, list) and settings(noted) == settings_given:
        return [str(override) for override in noted]
    return [f"{key}={value}" for key, value in settings_given.items()]


def _metrics(folder: Path, keys: set[str]) -> pd.DataFrame | None:
    """All numbers that the stages of a job measured, None if they measure nothing.

    ValueError if what they left is there no more.
    """
    tables = []
    for file in sorted(folder.glob(f"*/{METRICS_FILE}")):
        table = pd.read_csv(file, dtype={"method": str, "axis": str})
        where = f"{file.parent.name}/{METRICS_FILE}"
        missing = [name for name in METRIC_COLUMNS if name not in table]
        if missing:
            raise ValueError(f"{where}: no column {', '.join(missing)}")
        twice = sorted(keys & set(table))
        if twice:
            raise ValueError(f"{where}: column {twice[0]} is an override as well")
        tables.append(table.astype({"cycle": "Int64", "n": "Int64", "value": float}))
    if tables:
        return pd.concat(tables, ignore_index=True)
    _refuse_lost(folder, METRICS_FILE)
    return None


def _diagnoses(folder: Path) -> list[Entry]:
    """What a job's diagnosis says, nothing if it made none; ValueError if that is lost."""
    found = read_diagnoses(folder)
    if not found:
        _refuse_lost(folder, DIAGNOSIS_FILE)
    return found


def _refuse_lost(folder: Path, name: str) -> None:
    """ValueError if a stage left a file of that name: it is not there any more."""
    noted = json.loads((folder / "provenance.json").read_text(encoding="utf-8"))
    left = [file for stage in noted["stages"] for file in stage["outputs"]]
    lost = [file for file in left if Path(file).name == name]
    if lost:
        raise ValueError(f"{lost[0]} is not there any more")


def _origin(folder: Path) -> dict[str, str]:
    """Commit, configuration and data of a job; `unknown` where it was not noted."""
    config = read_yaml(folder / "config.yaml")
    for section, name in NO_SAY:
        config.get(section, {}).pop(name, None)
    try:
        noted = json.loads((folder / "provenance.json").read_text(encoding="utf-8"))
        commit, data = _commit(noted["code"]), _measured(noted["stages"])
    except (OSError, ValueError, KeyError, TypeError):
        commit, data = None, {}
    return {
        "commit": commit or UNKNOWN,
        "config_hash": digest(config),
        "data_hash": digest(data) if data else UNKNOWN,
    }


def _commit(code: dict[str, Any]) -> str | None:
    """The commit, with the hash of what was changed since; else the hash of the installed files."""
    if code["commit"] is None:
        return f"source {code['source']}"
    changed = code["uncommitted"]
    return code["commit"] if changed is None else f"{code['commit']} with changes {changed}"


def _measured(stages: list[dict[str, Any]]) -> dict[str, str]:
    """Hashes of the measured samples: of what vision left, else of what the stages read."""
    left = [s["outputs"] for s in stages if s["stage"] == "vision"]
    read = [s["inputs"] for s in stages]
    return {
        name: value
        for files in left or read
        for name, value in files.items()
        if Path(name).name.startswith("samples.")
    }


def _natural(name: str) -> list[tuple[int, str]]:
    parts = re.findall(r"\d+|\D+", name)
    return [(int(part), "") if part.isdigit() else (-1, part) for part in parts]

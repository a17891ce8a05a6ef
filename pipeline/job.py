"""One job: a run of its own or one of a sweep, its status, its provenance, its way on after a stop.

`job.json`, the status, is {"overrides": {key: value}, "number", "status": "running" | "done" |
"failed", "error": text or null}; `provenance.json` is of `tracking.provenance`.
"""

import json
import sys
import traceback
from collections.abc import Callable
from contextlib import ExitStack, redirect_stderr, redirect_stdout, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pipeline.atomically import write_atomically
from pipeline.config import Config
from pipeline.errors import LoopgapError
from pipeline.run import run_stages
from pipeline.runners.stage_run import Workplace
from pipeline.tracking.cache import StageCache
from pipeline.tracking.files import locked
from pipeline.tracking.progress import note_end
from pipeline.tracking.provenance import PROVENANCE_FILE, code, now, provenance
from pipeline.tracking.stage_record import FROM_BEFORE, StageRecord

JOB_FILE = "job.json"
PRINTED_FILE = "printed.txt"
SHARED = "shared"


@dataclass(frozen=True)
class Job:
    """Where a job writes, what it was told on the command line, and its sweep's folder, if any."""

    folder: Path
    overrides: list[str]
    number: int = 0
    sweep: Path | None = None

    def note(self, status: str, error: str | None = None) -> None:
        """Write job.json; on a full disk into the room of the old one."""
        entry = {"overrides": self.told(), "number": self.number, "status": status, "error": error}
        file, text = self.folder / JOB_FILE, json.dumps(entry, indent=1)
        try:
            write_atomically(file, text)
        except OSError:
            file.write_text(text, encoding="utf-8")

    def told(self) -> dict[str, str]:
        """The overrides by their keys."""
        return dict(o.lstrip("+~").split("=", 1) for o in self.overrides if "=" in o)

    def noted(self) -> dict[str, Any]:
        """What job.json says; nothing where it can't be read."""
        try:
            entry = json.loads((self.folder / JOB_FILE).read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return {}
        return entry if isinstance(entry, dict) else {}


def run_job(job: Job, configure: Callable[[], tuple[Config, str]]) -> None:
    """Do what is missing of a job; `configure` gives its configuration, also as YAML.

    In a sweep an error is noted and said, and the next job may begin; what is printed goes to
    `printed.txt`. Else it is noted, and goes on.
    """
    with locked(job.folder / ".lock", lambda: _say(f"{job.folder} is in use: waiting")):
        try:
            _do(job, configure)
        except BaseException as error:
            with suppress(OSError):  # of a full disk; the first error says it
                job.note("failed", f"{type(error).__name__}: {error}")
            if job.sweep is None or not isinstance(error, Exception):
                raise
            note_end(job.sweep, job.number, "failed", job.overrides)
            _say(f"job {job.number}: {error}")
            if not isinstance(error, LoopgapError | OSError):
                traceback.print_exception(error)


def _do(job: Job, configure: Callable[[], tuple[Config, str]]) -> None:
    began = now()
    noted = job.noted()
    was_done = noted.get("status") == "done" and noted.get("overrides") == job.told()
    for part in job.folder.rglob(".*.part"):  # of a process that was killed: the lock is ours
        part.unlink()
    if not was_done:
        job.note("running")
    config, text = configure()
    cache = StageCache(Path(config.cache.folder)) if config.cache.use else None
    if cache is not None:
        cache.tidy()
    place = Workplace(
        cache,
        None if job.sweep is None else job.sweep / SHARED,
        lambda: job.note("running"),
    )
    with ExitStack() as stack:
        if job.sweep is not None:
            file = stack.enter_context((job.folder / PRINTED_FILE).open("w", encoding="utf-8"))
            stack.enter_context(redirect_stdout(file))
            stack.enter_context(redirect_stderr(file))
        write_atomically(job.folder / "config.yaml", text)
        records: list[StageRecord] = []
        try:
            for record in run_stages(config, job.folder, place):
                records.append(record)  # one by one: what was done before an error counts
        except BaseException:
            with suppress(OSError):
                _write_provenance(job, config, began, "failed", records)
            raise
    if not was_done or any(record.made != FROM_BEFORE for record in records):
        _write_provenance(job, config, began, "done", records)
        job.note("done")
        ended = "done"
    else:
        ended = "done before"
    if job.sweep is not None:
        note_end(job.sweep, job.number, ended, job.overrides)


def _write_provenance(
    job: Job, config: Config, began: str, status: str, records: list[StageRecord]
) -> None:
    diff_file = None
    if code().uncommitted is not None:
        name = f"uncommitted-{str(code().uncommitted)[:12]}.diff"
        file = (job.sweep or job.folder) / name
        if not file.exists():
            write_atomically(file, code().diff)
        diff_file = name if job.sweep is None else f"../{name}"
    document = provenance(config, job.overrides, began, status, records, diff_file)
    write_atomically(job.folder / PROVENANCE_FILE, json.dumps(document, indent=1))


def _say(text: str) -> None:
    print(f"loopgap: {text}", file=sys.stderr, flush=True)

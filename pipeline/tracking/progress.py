"""Progress of a sweep: jobs done, failed and left, and the time to go, in one line a job."""

import json
import os
import sys
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TextIO

PROGRESS_FILE = "progress.jsonl"
LOOK_EVERY_S = 0.3


def note_end(sweep: Path, number: int, status: str, overrides: Sequence[str]) -> None:
    """Say to whoever watches the sweep that a job ended: done, done before, or failed."""
    entry = {"job": number, "status": status, "overrides": list(overrides)}
    line = f"{json.dumps(entry)}\n".encode()
    with suppress(OSError):  # job.json says the same; a full disk is told of elsewhere
        descriptor = os.open(sweep / PROGRESS_FILE, os.O_CREAT | os.O_APPEND | os.O_WRONLY, 0o644)
        try:
            os.write(descriptor, line)
        finally:
            os.close(descriptor)


class Tally:
    """Counts of a sweep of `jobs` jobs since it was started, or gone on with."""

    def __init__(self, jobs: int, began_s: float) -> None:
        self._jobs, self._began_s = jobs, began_s
        self._done = self._failed = self._worked = 0

    def line(self, entry: dict[str, object], now_s: float) -> str:
        """Count one job's end, and say how things stand."""
        failed = entry["status"] == "failed"
        self._failed += failed
        self._done += not failed
        self._worked += entry["status"] != "done before"
        left = max(0, self._jobs - self._done - self._failed)
        overrides = entry["overrides"]
        told = " ".join(overrides) if isinstance(overrides, list) else ""
        return (
            f"{self._done} done, {self._failed} failed, {left} left{self._to_go(left, now_s)}: "
            f"job {entry['job']} {entry['status']} ({told})"
        )

    def _to_go(self, left: int, now_s: float) -> str:
        if not left or not self._worked:
            return ""
        return f", {duration(left * (now_s - self._began_s) / self._worked)} to go"


def duration(seconds: float) -> str:
    """A span of time for people: 40 s, 12 min, 3.5 h."""
    if seconds < 90:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 90 * 60 else f"{seconds / 3600:.1f} h"


@contextmanager
def watched(sweep: Path, jobs: int) -> Iterator[None]:
    """Print a line for each job of a sweep that ends meanwhile, in whatever process."""
    file = sweep / PROGRESS_FILE
    begin = file.stat().st_size if file.exists() else 0
    stop = threading.Event()
    arguments = (file, begin, Tally(jobs, time.monotonic()), stop, sys.stdout)
    thread = threading.Thread(target=_watch, args=arguments, daemon=True)
    thread.start()
    try:
        yield
    finally:
        stop.set()
        thread.join()


def _watch(file: Path, begin: int, tally: Tally, stop: threading.Event, out: TextIO) -> None:
    while True:
        last = stop.wait(LOOK_EVERY_S)
        begin = _tell(file, begin, tally, out)
        if last:
            return


def _tell(file: Path, begin: int, tally: Tally, out: TextIO) -> int:
    try:
        with file.open("rb") as lines:
            lines.seek(begin)
            new = lines.read()
    except OSError:
        return begin
    whole = new[: new.rfind(b"\n") + 1]
    for line in whole.splitlines():
        print(tally.line(json.loads(line), time.monotonic()), file=out, flush=True)
    return begin + len(whole)

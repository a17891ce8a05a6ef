"""Provenance: from what, with what, where and when the results of a job were made.

`provenance.json` of a job, schema loopgap.provenance/1: command, overrides, configuration (all of
it, resolved), seed, code (`commit`, `uncommitted`: null or the hash of the diff, `diff`: the file
that holds it, `source`: hash of the package's files), packages, python, machine, began, ended,
status, and for each stage what it read (`inputs`) and left (`outputs`) as hashes, its wall time and
whether it ran or its result was taken from elsewhere (`made`).
"""

import hashlib
import os
import platform
import subprocess
import sys
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import Any

from pipeline.config import Config
from pipeline.tracking.hashes import digest, files_matching, grouped, hashes_of
from pipeline.tracking.stage_record import StageRecord

SCHEMA = "loopgap.provenance/1"
PROVENANCE_FILE = "provenance.json"
PACKAGE = Path(__file__).resolve().parents[1]
GIT_S = 20.0
PLAIN_DIFF = ("--no-color", "--no-ext-diff")


@dataclass(frozen=True)
class Code:
    """The program: its commit where it is a checkout, what was changed since, and its files."""

    commit: str | None
    diff: str
    source: str

    @property
    def uncommitted(self) -> str | None:
        """Hash of the changes since the commit; None where there are none."""
        return hashlib.sha256(self.diff.encode()).hexdigest() if self.diff else None


@cache
def code() -> Code:
    """What runs here, looked at once a process."""
    names = files_matching(PACKAGE, ["**/*.py", "**/*.jinja"])
    source = digest(hashes_of(PACKAGE, names))
    commit = _git("rev-parse", "HEAD")
    if commit is None or _git("ls-files", "--error-unmatch", str(PACKAGE / "app.py")) is None:
        return Code(None, "", source)  # installed, maybe into the checkout of something else
    diff = _git("diff", "HEAD", *PLAIN_DIFF) or ""
    new = _git("ls-files", "-z", "--others", "--exclude-standard", "pipeline", "conf") or ""
    for name in new.split("\0")[:-1]:
        diff += _git("diff", *PLAIN_DIFF, "--no-index", "/dev/null", name) or ""
    return Code(commit.strip(), diff, source)


def provenance(
    config: Config,
    overrides: list[str],
    began: str,
    status: str,
    stages: list[StageRecord],
    diff_file: str | None,
) -> dict[str, Any]:
    """The document; `diff_file` is where the uncommitted changes stand, seen from the job."""
    return {
        "schema": SCHEMA,
        "command": sys.argv,
        "overrides": overrides,
        "configuration": asdict(config),
        "seed": config.seed,
        "code": {
            "commit": code().commit,
            "uncommitted": code().uncommitted,
            "diff": diff_file,
            "source": code().source,
        },
        "packages": packages(),
        "python": platform.python_version(),
        "machine": machine(),
        "began": began,
        "ended": now(),
        "status": status,
        "stages": [_said_of(record) for record in stages],
    }


def now() -> str:
    """The time in UTC, as text that sorts."""
    return datetime.now(UTC).isoformat(timespec="milliseconds")


@cache
def packages() -> dict[str, str]:
    """Every installed distribution and its version."""
    found = {d.metadata["Name"]: d.version for d in metadata.distributions()}
    return dict(sorted(found.items(), key=lambda entry: entry[0].lower()))


@cache
def machine() -> dict[str, object]:
    """What the job runs on."""
    return {
        "name": platform.node(),
        "system": platform.platform(),
        "architecture": platform.machine(),
        "processor": _processor(),
        "processors": os.cpu_count(),
    }


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.processor()
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor()


def _said_of(record: StageRecord) -> dict[str, Any]:
    return {
        "stage": record.stage,
        "key": record.key,
        "made": record.made,
        "began": record.began,
        "wall_time_s": record.wall_time_s,
        "inputs": grouped(record.inputs),
        "outputs": grouped(record.outputs),
    }


def _git(*arguments: str) -> str | None:
    """What git says of the checkout that the package stands in; None where it says nothing."""
    command = ["git", "-C", str(PACKAGE.parent), *arguments]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=GIT_S)
    except (OSError, subprocess.TimeoutExpired):
        return None
    return done.stdout if done.returncode == 0 or "--no-index" in arguments else None

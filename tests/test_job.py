"""A job notes how it ended, whatever the disk."""

import json
from pathlib import Path

import pytest

from pipeline import job as jobs
from pipeline.job import Job


def test_a_job_notes_its_end_in_the_room_of_its_beginning(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    job = Job(tmp_path, ["seed=1"])
    job.note("running")

    def full(path: Path, _content: str) -> None:
        raise OSError(28, "No space left on device", str(path))

    monkeypatch.setattr(jobs, "write_atomically", full)
    job.note("failed", "OSError: No space left on device")
    noted = json.loads((tmp_path / "job.json").read_text())
    assert (noted["status"], noted["overrides"]) == ("failed", {"seed": "1"})
    assert "No space" in noted["error"]

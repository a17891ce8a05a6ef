"""Progress: what a sweep's watcher says of jobs that end in any process."""

from pathlib import Path

import pytest

from pipeline.tracking.progress import Tally, duration, note_end, watched


def test_counts_and_time_to_go() -> None:
    tally = Tally(jobs=5, began_s=100.0)
    end = {"job": 3, "status": "done before", "overrides": ["seed=1"]}
    assert tally.line(end, 100.0) == "1 done, 0 failed, 4 left: job 3 done before (seed=1)"
    assert tally.line(end | {"status": "done"}, 120.0).startswith(
        "2 done, 0 failed, 3 left, 60 s to go: job 3 done"
    )
    assert tally.line(end | {"status": "failed"}, 120.0).startswith(
        "2 done, 1 failed, 2 left, 20 s to go"
    )


@pytest.mark.parametrize(
    ("seconds", "said"), [(89.4, "89 s"), (90.0, "2 min"), (5399.0, "90 min"), (9000.0, "2.5 h")]
)
def test_durations_are_for_people(seconds: float, said: str) -> None:
    assert duration(seconds) == said


def test_a_line_for_each_end_since_the_start(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    note_end(tmp_path, 0, "done", ["of an earlier try"])
    with watched(tmp_path, 2):
        note_end(tmp_path, 0, "done before", ["seed=0"])
        note_end(tmp_path, 1, "failed", ["seed=1"])
    lines = capsys.readouterr().out.splitlines()
    assert [line.split(": ")[1] for line in lines] == [
        "job 0 done before (seed=0)",
        "job 1 failed (seed=1)",
    ]

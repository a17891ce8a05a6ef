"""The stage cache: whole or not at all, proven when read, safe with many writers."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from pipeline.tracking.cache import StageCache
from pipeline.tracking.files import UNFINISHED, locked
from pipeline.tracking.hashes import files_matching, hashes_of, matches
from pipeline.tracking.stage_record import FROM_CACHE, StageRecord

KEY = "ab" + 62 * "0"
FILES = {"training/yaw.json": b"{}", "training/pitch.json": bytes(range(256))}


def result(folder: Path) -> StageRecord:
    for name, data in FILES.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(data)
    return StageRecord("training", KEY, "2026", 1.5, outputs=hashes_of(folder, FILES), said="a\n")


def files(folder: Path) -> dict[str, bytes]:
    return {f.relative_to(folder).as_posix(): f.read_bytes() for f in folder.rglob("*.json")}


def test_a_kept_result_comes_back_as_it_was(tmp_path: Path) -> None:
    cache = StageCache(tmp_path / "cache")
    assert cache.get(KEY) is None
    record = result(tmp_path / "run")
    cache.put(record, tmp_path / "run")
    found = cache.get(KEY)
    assert found is not None
    assert (found.made, found.outputs, found.said) == (FROM_CACHE, record.outputs, "a\n")
    assert cache.bring(found, tmp_path / "other")
    assert files(tmp_path / "other") == FILES


@pytest.mark.parametrize("harm", ["changed", "missing", "record"])
def test_a_damaged_result_is_said_discarded_and_may_be_kept_anew(
    harm: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    cache = StageCache(tmp_path / "cache")
    record = result(tmp_path / "run")
    cache.put(record, tmp_path / "run")
    (kept,) = (tmp_path / "cache").rglob("yaw.json")
    if harm == "changed":
        kept.write_bytes(b"{ ")
    elif harm == "missing":
        kept.unlink()
    else:
        (kept.parents[1] / "record.json").write_text("{")
    found = cache.get(KEY)
    assert found is None or not cache.bring(found, tmp_path / "other")
    assert "discarded, it will be made anew" in capsys.readouterr().err
    assert cache.get(KEY) is None
    cache.put(record, tmp_path / "run")
    found = cache.get(KEY)
    assert found is not None
    assert cache.bring(found, tmp_path / "another")
    assert files(tmp_path / "another") == FILES


def test_a_result_that_changed_while_it_was_kept_is_not_kept(tmp_path: Path) -> None:
    cache = StageCache(tmp_path / "cache")
    record = result(tmp_path / "run")
    (tmp_path / "run" / "training" / "yaw.json").write_bytes(b"[]")
    cache.put(record, tmp_path / "run")
    assert cache.get(KEY) is None
    assert list((tmp_path / "cache").glob(f"{UNFINISHED}/*")) == []


def test_the_second_writer_leaves_what_the_first_kept(tmp_path: Path) -> None:
    record = result(tmp_path / "run")
    for _ in range(2):
        StageCache(tmp_path / "cache").put(record, tmp_path / "run")
    assert len(list((tmp_path / "cache").rglob("record.json"))) == 1
    assert list((tmp_path / "cache").glob(f"{UNFINISHED}/*")) == []


def test_a_cache_that_can_not_be_written_is_said_once_and_done_without(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "cache").write_text("a file")
    cache = StageCache(tmp_path / "cache")
    record = result(tmp_path / "run")
    with cache.alone(KEY):
        cache.put(record, tmp_path / "run")
    assert cache.get(KEY) is None
    assert capsys.readouterr().err.count("can't be written") == 1


HOLD = """
import pathlib, sys, time
from pipeline.tracking.files import appear, locked
def fill(folder):
    (folder / "half").write_text("half")
    print("holding", flush=True)
    time.sleep(60)
with locked(pathlib.Path(sys.argv[1]) / "lock"):
    appear(pathlib.Path(sys.argv[1]) / "ab" / "whole", fill, pathlib.Path(sys.argv[1]))
"""


def test_a_killed_process_leaves_no_lock_and_no_half_result(tmp_path: Path) -> None:
    command = [sys.executable, "-c", HOLD, str(tmp_path)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    assert process.stdout.readline() == "holding\n"
    waited = []
    assert not (tmp_path / "ab" / "whole").exists()
    StageCache(tmp_path).tidy()
    assert len(list(tmp_path.rglob("half"))) == 1  # its process is alive
    with locked(
        tmp_path / "lock", lambda: (waited.append(1), os.kill(process.pid, signal.SIGKILL))
    ):
        process.communicate()
        assert waited == [1]
    StageCache(tmp_path).tidy()
    assert list(tmp_path.rglob("half")) == []


def test_a_record_of_another_kind_is_no_record() -> None:
    text = json.dumps(json.loads(StageRecord("a", KEY, "", 0.0).as_json()) | {"more": 1})
    with pytest.raises(ValueError, match="no record"):
        StageRecord.from_json(text)


@pytest.mark.parametrize("pattern", ["a/*.json", "a/*", "a", "*/b.json"])
def test_names_match_as_files_are_found(pattern: str, tmp_path: Path) -> None:
    names = ["a/b.json", "a/c.csv", "a/d/e.json", "f/b.json", "f.json"]
    for name in (*names, "a/.b.json.1.part", ".stages/b.json"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).touch()
    found = files_matching(tmp_path, [pattern])
    assert found == sorted(name for name in names if matches(name, pattern))
    assert found

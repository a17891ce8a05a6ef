"""The stage cache: results under the hash of all that decides on them, in plain files.

A result lies in `<folder>/<two letters>/<key>/`: `record.json` (what it is, with the hash of each
file) and the files themselves. It appears whole, is proven whenever it is read, and may be written
by any number of processes at a time. To delete the folder, or any part of it, is always safe.
"""

import shutil
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path

from pipeline.atomically import write_atomically
from pipeline.tracking.files import (
    CorruptError,
    appear,
    copy_proven,
    locked,
    remove_unfinished,
)
from pipeline.tracking.stage_record import FROM_CACHE, StageRecord

RECORD_FILE = "record.json"


@dataclass
class StageCache:
    """A folder of kept results; one that can't be written is still read, and that is said once."""

    folder: Path
    writable: bool = field(default=True, init=False)

    def get(self, key: str) -> StageRecord | None:
        """What is kept under a key; None where nothing is. Its files are not looked at yet."""
        try:
            text = (self._place(key) / RECORD_FILE).read_text(encoding="utf-8")
        except OSError:
            return None
        try:
            record = StageRecord.from_json(text)
        except ValueError:
            record = None
        if record is None or record.key != key:
            self.discard(key, "its record can't be read")
            return None
        return replace(record, made=FROM_CACHE)

    def bring(self, record: StageRecord, target: Path) -> bool:
        """Copy a result into a folder; False if it was corrupt: then it is discarded."""
        try:
            copy_proven(self._place(record.key), target, record.outputs)
        except CorruptError as error:
            self.discard(record.key, str(error))
            return False
        return True

    def put(self, record: StageRecord, folder: Path) -> None:
        """Keep a result that lies in a run's folder; what is there already is left."""
        place = self._place(record.key)

        def fill(entry: Path) -> None:
            copy_proven(folder, entry, record.outputs)
            write_atomically(entry / RECORD_FILE, record.as_json())

        if not self.writable or place.exists():
            return
        try:
            appear(place, fill, self.folder)
        except CorruptError as error:
            _say(f"{error} while it was kept: not kept")
        except OSError as error:
            self._give_up(error)

    @contextmanager
    def alone(self, key: str) -> Iterator[None]:
        """While held, no other process makes the result of this key."""
        lock = self.folder / "locks" / key[:3]
        try:
            lock.parent.mkdir(parents=True, exist_ok=True)
            lock.touch()
        except OSError as error:
            self._give_up(error)
            yield
            return
        with locked(lock):
            yield

    def discard(self, key: str, why: str) -> None:
        """Take a result out, and say so."""
        _say(f"{why}; discarded, it will be made anew")
        shutil.rmtree(self._place(key), ignore_errors=True)

    def tidy(self) -> None:
        """Remove what killed processes left half done."""
        remove_unfinished(self.folder)

    def _place(self, key: str) -> Path:
        return self.folder / key[:2] / key

    def _give_up(self, error: OSError) -> None:
        if self.writable:
            _say(f"can't be written ({error}): results are not kept for other runs")
        self.writable = False


def _say(text: str) -> None:
    print(f"loopgap: cache: {text}", file=sys.stderr, flush=True)

"""Folders that appear whole or not at all, files copied under proof, and locks that die with us."""

import errno
import fcntl
import hashlib
import os
import shutil
import socket
import uuid
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

UNFINISHED = ".unfinished"
NO_LOCKS = (errno.ENOLCK, errno.ENOTSUP, errno.ENOSYS)


class CorruptError(Exception):
    """A file is not the one that was kept."""


def copy_proven(source: Path, target: Path, hashes: Mapping[str, str]) -> None:
    """Copy the named files between folders; CorruptError where one hasn't the hash it should have.

    What was copied until then stays.
    """
    for name, expected in hashes.items():
        try:
            data = (source / name).read_bytes()
        except FileNotFoundError as error:
            raise CorruptError(f"{source / name} is missing") from error
        if hashlib.sha256(data).hexdigest() != expected:
            raise CorruptError(f"{source / name} was changed")
        (target / name).parent.mkdir(parents=True, exist_ok=True)
        (target / name).write_bytes(data)


def appear(folder: Path, fill: Callable[[Path], None], store: Path) -> None:
    """Let `fill` write a folder that others see at once and whole; an earlier winner's stays.

    Until then it is in `store`'s folder `.unfinished`, on the same file system.
    """
    name = f"{socket.gethostname()}-{os.getpid()}-{uuid.uuid4().hex}"
    beside = store / UNFINISHED / name
    beside.mkdir(parents=True)
    try:
        fill(beside)
        folder.parent.mkdir(parents=True, exist_ok=True)
        beside.rename(folder)
    except OSError as error:
        if error.errno not in (errno.ENOTEMPTY, errno.EEXIST):
            raise
    finally:
        shutil.rmtree(beside, ignore_errors=True)


def remove_unfinished(store: Path) -> None:
    """Remove what dead processes of this machine left half done in a store."""
    mine = f"{socket.gethostname()}-"
    for path in (store / UNFINISHED).glob(f"{mine}*"):
        if not _alive(path.name.removeprefix(mine)):
            shutil.rmtree(path, ignore_errors=True)


@contextmanager
def locked(file: Path, when_waiting: Callable[[], None] = lambda: None) -> Iterator[None]:
    """Hold a lock that the system takes back when this process ends, however it ends.

    Where the file system has no locks, nothing is locked: work may then be done twice, not wrongly.
    """
    file.parent.mkdir(parents=True, exist_ok=True)
    descriptor = os.open(file, os.O_CREAT | os.O_RDWR, 0o666)
    try:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            when_waiting()
            fcntl.flock(descriptor, fcntl.LOCK_EX)
        except OSError as error:
            if error.errno not in NO_LOCKS:
                raise
        yield
    finally:
        os.close(descriptor)


def _alive(rest: str) -> bool:
    try:
        os.kill(int(rest.split("-")[0]), 0)
    except ProcessLookupError:
        return False
    except (PermissionError, ValueError):
        return True
    return True

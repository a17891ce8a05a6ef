"""SHA-256 of files and of settings: what a stage read, what it left, what it was told."""

import hashlib
import json
from collections.abc import Iterable, Mapping
from fnmatch import fnmatchcase
from functools import lru_cache
from pathlib import Path, PurePosixPath

LISTED_AT_MOST = 20


def sha256_of(path: Path) -> str:
    """Hash of a file's bytes; asked again in this process, an untouched file isn't read again."""
    status = path.stat()
    return _sha256(str(path), status.st_ino, status.st_size, status.st_mtime_ns, status.st_ctime_ns)


def files_matching(root: Path, patterns: Iterable[str]) -> list[str]:
    """Files of the matches, those in matched folders too, relative to `root`, sorted.

    Names that begin with a dot are no results: they are files in the making, and notes.
    """
    found: set[str] = set()
    for pattern in patterns:
        for match in root.glob(pattern):
            files = match.rglob("*") if match.is_dir() else [match]
            found |= {f.relative_to(root).as_posix() for f in files if f.is_file()}
    return sorted(
        name
        for name in found
        if not any(part.startswith(".") for part in PurePosixPath(name).parts)
    )


def matches(name: str, pattern: str) -> bool:
    """Whether `files_matching` would find a file of this name."""
    parts, wanted = name.split("/"), pattern.split("/")
    return len(parts) >= len(wanted) and all(map(fnmatchcase, parts, wanted))


def hashes_of(root: Path, names: Iterable[str]) -> dict[str, str]:
    """Name -> hash, of files below `root`."""
    return {name: sha256_of(root / name) for name in names}


def digest(value: object) -> str:
    """Hash of plain data (anything that JSON holds), whatever the order of its keys."""
    return hashlib.sha256(json.dumps(value, sort_keys=True).encode()).hexdigest()


def grouped(hashes: Mapping[str, str]) -> dict[str, str]:
    """The same for reading: a folder of many files (frames) becomes one line, `folder/ (n files)`.

    The hash of such a line is `digest` of the names and hashes in it.
    """
    folders: dict[str, dict[str, str]] = {}
    for name, value in hashes.items():
        folders.setdefault(str(PurePosixPath(name).parent), {})[name] = value
    listed: dict[str, str] = {}
    for folder, members in folders.items():
        if len(members) <= LISTED_AT_MOST:
            listed |= members
        else:
            listed[f"{folder}/ ({len(members)} files)"] = digest(members)
    return dict(sorted(listed.items()))


@lru_cache(maxsize=100_000)
def _sha256(path: str, *_status: int) -> str:
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()

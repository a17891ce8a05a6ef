"""The code that decides on a stage's result: its module and all that it imports, and libraries."""

import platform
import re
from collections.abc import Iterator
from functools import cache
from importlib import metadata
from pathlib import Path

from pipeline.tracking.hashes import digest, sha256_of

PACKAGE = Path(__file__).resolve().parents[1]
DISTRIBUTIONS = {
    "cv2": "opencv-python-headless",
    "PIL": "pillow",
    "rerun": "rerun-sdk",
    "serial": "pyserial",
    "sklearn": "scikit-learn",
}
NUMERICS = frozenset({"numpy", "scipy"})  # beneath all others
IMPORT = re.compile(
    r"^[ \t]*(?:from[ \t]+(\w[\w.]*)[ \t]+)?import[ \t]+(\([^)]*\)|[^\n]+)", re.MULTILINE
)


@cache
def code_of(module: str) -> str:
    """Hash of the sources of a `pipeline` module and of all that it imports, however deep.

    Functions that import when they are called count too; templates count with their neighbours.
    """
    sources: set[Path] = set()
    for name in _reached(module):
        file = _file_of(name)
        sources |= {file, *(file.parent / "templates").glob("*")} if file else set()
    return digest({p.relative_to(PACKAGE).as_posix(): sha256_of(p) for p in sources})


@cache
def libraries_of(module: str) -> dict[str, str]:
    """Version of Python, of the processor's family and of each library that the code imports."""
    tops = {
        name.split(".")[0] for reached in _reached(module) for name in _imports(reached)
    } | NUMERICS
    versions = {"python": platform.python_version(), "architecture": platform.machine()}
    for top in sorted(tops - {"pipeline"}):
        name = DISTRIBUTIONS.get(top, top)
        try:
            versions[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            continue  # of the standard library
    return versions


@cache
def _reached(module: str) -> frozenset[str]:
    reached: set[str] = set()
    waiting = [module]
    while waiting:
        name = waiting.pop()
        if name not in reached and _file_of(name) is not None:
            reached.add(name)
            waiting += [n for n in _imports(name) if n.split(".")[0] == "pipeline"]
    return frozenset(reached)


@cache
def _imports(module: str) -> frozenset[str]:
    """Every name that a module's source imports, packages on the way included.

    Lines that begin as an import does are read, for to parse all sources takes most of a second:
    one of a docstring may count as well.
    """
    file = _file_of(module)
    assert file is not None
    names: set[str] = set()
    for package, imported in IMPORT.findall(file.read_text("utf-8")):
        without_comments = re.sub(r"#[^\n]*", "", imported.strip("()"))
        words = [part.split()[0] for part in without_comments.split(",") if part.strip()]
        names |= {package, *(f"{package}.{word}" for word in words)} if package else set(words)
    return frozenset(part for name in names for part in _with_packages(name))


def _with_packages(name: str) -> Iterator[str]:
    parts = name.split(".")
    for count in range(1, len(parts) + 1):
        yield ".".join(parts[:count])


def _file_of(module: str) -> Path | None:
    path = PACKAGE.parent.joinpath(*module.split("."))
    for file in (path.with_suffix(".py"), path / "__init__.py"):
        if file.is_file():
            return file
    return None

"""A run: what it was told, the folder that it writes, and what earlier stages left there."""

import json
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeVar

from tqdm import tqdm

from pipeline.commands import SUFFIX
from pipeline.config import Config
from pipeline.errors import UsageError, refusal
from pipeline.models.loop_model import LoopModel
from pipeline.recording import Recording, load_recording
from pipeline.split import split_cycles
from pipeline.tracking.hashes import files_matching, hashes_of, matches
from pipeline.tracking.progress import duration

IMPORTED = "recording"
T = TypeVar("T")
PLAIN_EVERY_S = 60.0


@dataclass(frozen=True)
class Kept:
    """The result of a stage that this run has brought about: name -> hash, and where it lies."""

    hashes: Mapping[str, str]
    folder: Path


@dataclass(frozen=True)
class Run:
    """A configuration, the folder that this run writes, and one whose results it may go on from.

    `kept`: what the stages of this run have left so far, by stage.
    """

    config: Config
    folder: Path
    earlier: Path | None = None
    kept: dict[str, Kept] = field(default_factory=dict)

    def roots(self, stage: str) -> list[Path]:
        """Where results of a stage may lie, the nearest first."""
        kept = [self.kept[stage].folder] if stage in self.kept else []
        return [*kept, self.folder, *([self.earlier] if self.earlier is not None else [])]

    def hashes(self, stage: str, pattern: str) -> dict[str, str]:
        """Name -> hash of the results of a stage that match, as `find` would find them."""
        if stage in self.kept:
            found = self.kept[stage].hashes.items()
            return {name: value for name, value in found if matches(name, pattern)}
        head = pattern.partition("/*")[0]
        root = next((r for r in self.roots(stage) if (r / head).exists()), None)
        return hashes_of(root, files_matching(root, [pattern])) if root is not None else {}

    def find(self, name: str, stage: str) -> Path:
        """Where `name`, a result of `stage`, lies; UsageError says how to come by it."""
        found = self.left(name, stage)
        if found is None:
            raise UsageError(
                refusal(str(self.folder / name), f"what the stage {stage!r} leaves", "nothing",
                        f"Add {stage!r} to `stages`, or name the run that did it: earlier=RUN_DIR.")
            )  # fmt: skip
        return found

    def left(self, name: str, stage: str) -> Path | None:
        """Where `name`, a result of `stage`, lies; None if it was not brought about."""
        return next((r / name for r in self.roots(stage) if (r / name).exists()), None)

    def given_recording(self) -> Path | None:
        """The recording that was named, or else the one that was imported; None without either."""
        if self.config.recording is not None:
            return Path(self.config.recording)
        imported = (root / IMPORTED for root in self.roots("importing"))
        return next((f for f in imported if (f / "recording.json").is_file()), None)

    def measured(self) -> dict[str, Recording]:
        """The recording of every axis that has both a command and a measured angle."""
        given = self.given_recording()
        folders = [given] if given else sorted(self.find("vision", "vision").iterdir())
        recordings = [load_recording(folder) for folder in folders]
        found = self.in_order(
            {axis: recording for recording in recordings for axis in measured_axes(recording)}
        )
        if not found:
            raise UsageError(
                refusal(str(folders[0]), "channels <axis>_command_deg and <axis>_angle_deg",
                        ", ".join(c.name for c in recordings[0].channels),
                        "Name the channels so, or look at the frames first: stages=[vision,...].")
            )  # fmt: skip
        return found

    def models(self) -> dict[str, LoopModel]:
        """The trained model of every axis."""
        files = sorted(self.find("training", "training").glob("*.json"))
        return self.in_order(
            {file.stem: LoopModel.from_json(json.loads(file.read_text())) for file in files}
        )

    def in_order(self, by_axis: Mapping[str, T]) -> dict[str, T]:
        """The axes in the order in which they are recorded, others behind."""
        known = [axis for axis in self.config.acquisition.axes if axis in by_axis]
        return {axis: by_axis[axis] for axis in (*known, *sorted(set(by_axis) - set(known)))}

    def split(self, recordings: Mapping[str, Recording]) -> tuple[list[int], list[int]]:
        """Training and test cycles, out of those that all recordings have."""
        cycles = [set(r.samples["cycle"].unique()) for r in recordings.values()]
        return split_cycles(self.config.split, sorted(set.intersection(*cycles)))


def measured_axes(recording: Recording) -> list[str]:
    """Axes of a recording: those with a command and a measured angle."""
    commands = {c.name.removesuffix(SUFFIX) for c in recording.with_role("command")}
    measured = (c.name.removesuffix("_angle_deg") for c in recording.with_role("measurement"))
    return [axis for axis in measured if axis in commands]


@contextmanager
def progress_bar(title: str, total: int) -> Iterator[Callable[[int], None]]:
    """A bar on a terminal; in a plain log a line a minute: on stderr, for neither is a result."""
    on_terminal = sys.stderr.isatty()
    said_s = began_s = time.monotonic()
    done = 0
    with tqdm(total=total, desc=f"  {title}", leave=False, disable=not on_terminal) as bar:

        def tick(count: int) -> None:
            nonlocal done, said_s
            done += count
            bar.update(count)
            now_s = time.monotonic()
            if not on_terminal and now_s - said_s > PLAIN_EVERY_S:
                said_s = now_s
                left_s = (now_s - began_s) * (total - done) / max(done, 1)
                say_now(f"{title}: {done} of {total}, {duration(left_s)} to go")

        yield tick


def say_now(doing: str) -> None:
    """Say what is being done, at once, also into a plain log: no result, so to stderr."""
    print(f"  {doing}", file=sys.stderr, flush=True)


def made(folder: Path) -> Path:
    """The folder, made with its parents where it was not there."""
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def fresh(parent: Path, name: str) -> Path:
    """`parent`/`name`-1, or with the first number that isn't there yet; made."""
    number = 1
    while (parent / f"{name}-{number}").exists():
        number += 1
    return made(parent / f"{name}-{number}")

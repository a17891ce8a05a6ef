"""A sweep: its folder, how many jobs it has, and the command that goes on where it stopped.

`sweep.json` in its folder says what was asked, so that the jobs of no other sweep mix with its own.
"""

import datetime
import json
import shlex
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from math import prod
from pathlib import Path

from hydra import compose, initialize_config_dir
from hydra._internal.utils import get_args_parser
from hydra.core.override_parser.overrides_parser import OverridesParser

from pipeline.atomically import write_atomically
from pipeline.errors import UsageError, refusal
from pipeline.job import SHARED
from pipeline.tracking.files import locked, remove_unfinished
from pipeline.tracking.planned import override
from pipeline.tracking.progress import watched

SWEEP_FILE = "sweep.json"
MULTIRUN = ("-m", "--multirun")
RUN_DIR, SWEEP_DIR = "hydra.run.dir=", "hydra.sweep.dir="
NO_SAY = ("hydra.run.", "hydra.sweep.", "hydra.launcher", "hydra/launcher", "cache.", "-")


@dataclass(frozen=True)
class Sweep:
    """Where a multirun writes, what it was asked, and how many jobs that makes."""

    folder: Path
    asked: list[str]
    jobs: int

    @contextmanager
    def running(self) -> Iterator[None]:
        """Alone in its folder, tidied of what a killed try left, with its progress printed.

        UsageError if the folder holds the jobs of another sweep, or this one runs already.
        """
        self.folder.mkdir(parents=True, exist_ok=True)
        with locked(self.folder / ".lock", self._refuse_second):
            self._claim()
            for part in self.folder.glob(".*.part"):
                part.unlink()
            remove_unfinished(self.folder / SHARED)
            with watched(self.folder, self.jobs):
                yield

    def _claim(self) -> None:
        file = self.folder / SWEEP_FILE
        if file.is_file():
            before = json.loads(file.read_text(encoding="utf-8"))
            if before.get("asked") != self.asked:
                raise UsageError(
                    refusal(str(self.folder), f"a sweep over {shlex.join(self.asked)}",
                            f"one over {shlex.join(before.get('asked', []))}",
                            "Ask the same again to go on, or write elsewhere: hydra.sweep.dir=OUT.")
                )  # fmt: skip
        write_atomically(file, json.dumps({"asked": self.asked, "jobs": self.jobs}, indent=1))

    def _refuse_second(self) -> None:
        raise UsageError(
            refusal(str(self.folder), "a folder of its own", "a sweep that is running there",
                    "Wait for it, or write elsewhere: hydra.sweep.dir=OUT.")
        )  # fmt: skip


def sweep_asked(arguments: Sequence[str], conf: Path) -> Sweep | None:
    """The sweep that a command line asks for, its folder chosen here where it names none."""
    if not set(MULTIRUN) & set(arguments):
        return None
    given = [a.removeprefix(SWEEP_DIR) for a in arguments if a.startswith(SWEEP_DIR)]
    stamp = f"{datetime.datetime.now():%Y-%m-%d_%H-%M-%S-%f}"
    folder = Path(given[-1].strip("'\"") if given else f"outputs/sweep_{stamp}")
    asked = sorted(a for a in arguments if not a.startswith(NO_SAY))
    return Sweep(folder, asked, _count(arguments, conf))


def going_on(arguments: Sequence[str], folder: Path) -> str:
    """The command that goes on with what a command began in a folder."""
    key = SWEEP_DIR if set(MULTIRUN) & set(arguments) else RUN_DIR
    rest = [a for a in arguments if not a.startswith(key)]
    return shlex.join(["loopgap", *rest, override(key.rstrip("="), folder)])


def options_first(arguments: Sequence[str]) -> list[str]:
    """The arguments in an order that Hydra's parser takes: it allows no option between overrides.

    Unknown options end the program with the parser's message.
    """
    overrides = get_args_parser().parse_intermixed_args(arguments).overrides
    return [a for a in arguments if a not in overrides] + overrides


def _count(arguments: Sequence[str], conf: Path) -> int:
    """Jobs of a sweep: the product of its choices, those of the configuration included."""
    parser = OverridesParser.create()
    told = get_args_parser().parse_intermixed_args(arguments)
    asked = parser.parse_overrides(told.overrides)
    plain = [o.input_line or "" for o in asked if not o.is_sweep_override()]
    if told.config_dir is not None:
        plain.append(f"hydra.searchpath=[file://{Path(told.config_dir).resolve()}]")
    with initialize_config_dir(str(conf), version_base="1.3"):
        settings = compose("config", overrides=plain, return_hydra_config=True).hydra
    params = [f"{k}={v}" for k, v in (settings.sweeper.get("params") or {}).items()]
    choices = {o.get_key_element(): o for o in (*parser.parse_overrides(params), *asked)}
    return prod(
        len(list(o.sweep_string_iterator())) for o in choices.values() if o.is_sweep_override()
    )

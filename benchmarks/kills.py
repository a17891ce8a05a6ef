"""Kill a sweep at random moments, fill its disk, take its folder away; then see what was lost.

    python benchmarks/kills.py --kills 200

Rounds of fresh sweeps: in most the command is killed (SIGKILL, the whole process group or the main
process alone) several times at random moments and started again until it ends; in some the disk is
too small (a tmpfs), or the folder turns immutable (chattr), before it may end: these need root, and
where it is not there they are left out and that is said. After every blow what claims to be whole
is proven; after every round each result is compared, byte by byte, with that of an undisturbed
sweep.
"""

import argparse
import hashlib
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

import pandas as pd

ROOT = Path(__file__).resolve().parents[1]
SWEEP = [
    "-m", "stages=[acquisition,vision,training,compensation,evaluation]", "evaluation.trial=false",
    "acquisition.cycles=4", "acquisition.steps_per_cycle=16", "camera.width_px=504",
    "camera.height_px=378", "vision.workers=1", "compensation.targets=12", "training.n_init=1",
    "split=leave_three_out", "split.index=0,1", "selection.k=1,2",
    "compensation/step_rule=armijo,newton",
]  # fmt: skip
RESULTS = ("training", "compensation", "evaluation")
KEY = ["job", "axis", "method", "metric"]
LONGEST_S = 600.0
MB = 1024 * 1024


@dataclass
class Tally:
    """What happened, and what it cost: `lost`, `corrupt` and `doubled` should stay 0."""

    blows: Counter[str] = field(default_factory=Counter)
    rounds: Counter[str] = field(default_factory=Counter)
    jobs: int = 0
    lost: int = 0
    corrupt: int = 0
    doubled: int = 0
    other_tables: int = 0
    silent: int = 0
    notes: list[str] = field(default_factory=list)

    def lines(self) -> list[str]:
        """The tally in words."""
        return [
            f"blows: {sum(self.blows.values())} "
            f"({', '.join(f'{n} {name}' for name, n in sorted(self.blows.items()))})",
            f"rounds: {sum(self.rounds.values())} "
            f"({', '.join(f'{n} {name}' for name, n in sorted(self.rounds.items()))}), "
            f"{self.jobs} jobs looked at",
            f"lost results: {self.lost}",
            f"corrupt results: {self.corrupt}",
            f"doubled results: {self.doubled}",
            f"final tables that differ from the undisturbed one: {self.other_tables}",
            f"full disks and unwritable folders that were not said with exit 1: {self.silent}",
            *self.notes,
        ]


@dataclass(frozen=True)
class Place:
    """Where one round works, its sweep and its cache, and what is asked there."""

    folder: Path
    asked: Sequence[str] = tuple(SWEEP)
    groups: list[int] = field(default_factory=list)

    @property
    def said(self) -> Path:
        """What the last command said, beside the folder, which may be full or locked."""
        return self.folder.with_name(f"{self.folder.name}.said")

    @property
    def sweep(self) -> Path:
        """The sweep's folder."""
        return self.folder / "sweep"

    @property
    def cache(self) -> Path:
        """The cache's folder."""
        return self.folder / "cache"

    def start(self) -> subprocess.Popen[bytes]:
        """Start the command, in a process group of its own; what it says goes to a file.

        Workers outlive a killed main process: a pipe would stay open as long as they do.
        """
        command = [
            sys.executable,
            "-m",
            "pipeline.app",
            *self.asked,
            f"hydra.sweep.dir={self.sweep}",
        ]
        settings = {"LOOPGAP_CACHE": str(self.cache), "OMP_NUM_THREADS": "1"}
        with self.said.open("w") as said:
            process = subprocess.Popen(
                command, cwd=ROOT, env=os.environ | settings, start_new_session=True,
                stdout=subprocess.DEVNULL, stderr=said,
            )  # fmt: skip
        self.groups.append(process.pid)
        return process

    def finish(self) -> tuple[int, str]:
        """Run the command to its end: exit status and what it said on stderr."""
        status = self.start().wait(LONGEST_S)
        return status, self.said.read_text()


def kill_at_random(place: Place, rng: random.Random, within_s: float, tally: Tally) -> bool:
    """Start, wait a random time, kill; False if the command had ended before."""
    process = place.start()
    try:
        process.wait(rng.uniform(0.0, within_s))
    except subprocess.TimeoutExpired:
        group = rng.random() < 0.5
        with suppress(ProcessLookupError):
            if group:
                os.killpg(process.pid, signal.SIGKILL)
            else:
                process.kill()
        tally.blows["of the group" if group else "of the main process alone"] += 1
        process.wait()
        return True
    return False


def prove(place: Place, tally: Tally) -> None:
    """Count what claims to be whole and is not: results in the cache, stages of jobs."""
    for head in place.cache.glob("??/*/record.json"):
        _prove_files(json.loads(head.read_text())["outputs"], head.parent, tally)
    for job in place.sweep.glob("*/job.json"):
        if json.loads(job.read_text())["status"] == "done":
            for head in (job.parent / ".stages").glob("*.json"):
                _prove_files(json.loads(head.read_text())["outputs"], job.parent, tally)


def _prove_files(hashes: dict[str, str], folder: Path, tally: Tally) -> None:
    for name, expected in hashes.items():
        try:
            found = hashlib.sha256((folder / name).read_bytes()).hexdigest()
        except FileNotFoundError:
            found = "missing"
        if found != expected:
            tally.corrupt += 1
            tally.notes.append(f"corrupt: {folder / name}")


def results_of(place: Place) -> dict[str, bytes]:
    """The bytes of every result of every job, by name."""
    return {
        file.relative_to(place.sweep).as_posix(): file.read_bytes()
        for name in RESULTS
        for file in sorted(place.sweep.glob(f"[0-9]*/{name}/*"))
    }


def tables_of(place: Place) -> dict[str, bytes]:
    """The bytes of the final tables, by name."""
    return {f.name: f.read_bytes() for f in sorted(place.sweep.glob("results.*"))}


def compare(place: Place, undisturbed: Place, tally: Tally) -> None:
    """Count what the round lost, changed or did twice."""
    expected, found = results_of(undisturbed), results_of(place)
    tally.jobs += len(list(place.sweep.glob("*/job.json")))
    tally.lost += len(set(expected) - set(found))
    tally.corrupt += sum(found[name] != expected[name] for name in set(expected) & set(found))
    tally.doubled += len(set(found) - set(expected))
    rows = [pd.read_csv(f) for f in sorted(place.sweep.glob("*/evaluation/metrics.csv"))]
    tally.doubled += sum(int(table.duplicated().sum()) for table in rows)
    tally.other_tables += tables_of(place) != tables_of(undisturbed)
    left = [*place.folder.rglob(".unfinished/*"), *place.folder.rglob("*.part")]
    tally.notes += [f"left lying: {file}" for file in left]


def killed_round(
    place: Place, rng: random.Random, within_s: float, kills: int, tally: Tally
) -> None:
    """Kill up to `kills` times, or until it ends before it is killed; then let it end."""
    for _ in range(kills):
        if not kill_at_random(place, rng, within_s, tally):
            break
        prove(place, tally)
    _end_well(place, tally)


def full_round(place: Place, rng: random.Random, needed: int, tally: Tally) -> None:
    """A disk that is too small; then more room; then let it end. The disk stays mounted."""
    place.folder.mkdir(parents=True)
    size = f"size={int(needed * rng.uniform(0.03, 0.9))}"
    _mount("-t", "tmpfs", "-o", size, "tmpfs", str(place.folder))
    _refused(place, "full disk", ("No space left",), tally)
    _mount("-o", f"remount,size={4 * needed + 64 * MB}", str(place.folder))
    prove(place, tally)
    _end_well(place, tally)


def locked_round(place: Place, rng: random.Random, within_s: float, tally: Tally) -> None:
    """A folder that turns immutable at a random moment; then free again; then let it end."""
    (place.folder / "sweep").mkdir(parents=True)
    _refused(
        place, "unwritable folder", ("not permitted", "denied"), tally, rng.uniform(0, within_s)
    )
    subprocess.run(["chattr", "-R", "-i", str(place.folder)], check=True, capture_output=True)
    prove(place, tally)
    _end_well(place, tally)


def _refused(
    place: Place, name: str, words: Sequence[str], tally: Tally, lock_after_s: float | None = None
) -> None:
    process = place.start()
    if lock_after_s is not None:
        with suppress(subprocess.TimeoutExpired):
            process.wait(lock_after_s)
        subprocess.run(["chattr", "-R", "+i", str(place.folder)], capture_output=True)
    process.wait(LONGEST_S)
    errors = place.said.read_text()
    if process.returncode == 0:  # it had ended before, or only the cache had no room: it goes on
        if "cache: can't be written" in errors:
            tally.blows[f"{name}, cache alone"] += 1
        return
    tally.blows[name] += 1
    said = any(word in errors for word in words)
    if process.returncode != 1 or not said or "Traceback" in errors:
        tally.silent += 1
        tally.notes.append(f"{name}: exit {process.returncode}: {errors[-700:]}")


def _end_well(place: Place, tally: Tally) -> None:
    status, errors = place.finish()
    if status:
        tally.notes.append(f"the command did not end well ({status}): {errors[-300:]}")


def _mount(*arguments: str) -> None:
    subprocess.run(["mount", *arguments], check=True, capture_output=True)


def missing_tools(folder: Path) -> str | None:
    """Why disks can't be filled and folders can't be locked here; None if they can."""
    if os.geteuid() != 0:
        return "not root"
    probe = folder / "probe"
    probe.mkdir()
    try:
        _mount("-t", "tmpfs", "-o", "size=1m", "tmpfs", str(probe))
        subprocess.run(["umount", str(probe)], check=True, capture_output=True)
        subprocess.run(["chattr", "+i", str(probe)], check=True, capture_output=True)
        subprocess.run(["chattr", "-i", str(probe)], check=True, capture_output=True)
    except (OSError, subprocess.CalledProcessError) as error:
        return str(error)
    return None


def run(kills: int, seed: int, folder: Path) -> Tally:
    """All rounds below a folder; the tally."""
    rng, tally = random.Random(seed), Tally()
    undisturbed = Place(folder / "undisturbed")
    began_s = time.monotonic()
    status, errors = undisturbed.finish()
    if status:
        raise SystemExit(f"the undisturbed sweep failed: {errors}")
    within_s = time.monotonic() - began_s
    needed = sum(512 * f.stat().st_blocks for f in undisturbed.folder.rglob("*"))
    print(f"undisturbed: {within_s:.1f} s, {needed / MB:.1f} MB", flush=True)
    missing = missing_tools(folder)
    if missing is not None:
        tally.notes.append(f"no full disks and no locked folders here: {missing}")
    number = 0
    while sum(tally.blows.values()) < kills:
        number += 1
        place = Place(folder / f"round-{number}")
        kind = rng.choice(["killed"] * 3 + ([] if missing else ["full", "locked"]))
        if kind == "killed":
            most = min(rng.randint(3, 12), kills - sum(tally.blows.values()))
            killed_round(place, rng, within_s, most, tally)
        elif kind == "full":
            full_round(place, rng, needed, tally)
        else:
            locked_round(place, rng, within_s, tally)
        tally.rounds[kind] += 1
        compare(place, undisturbed, tally)
        _remove(place)
        print(f"round {number}, {kind}: {sum(tally.blows.values())} blows, {tally.lost} lost, "
              f"{tally.corrupt} corrupt, {tally.doubled} doubled", flush=True)  # fmt: skip
    return tally


def _remove(place: Place) -> None:
    for group in place.groups:
        with suppress(ProcessLookupError):
            os.killpg(group, signal.SIGKILL)
    place.said.unlink()
    if place.folder.is_mount():
        subprocess.run(["umount", "-l", str(place.folder)], check=True)
    shutil.rmtree(place.folder, ignore_errors=True)


def main() -> None:
    """Print the tally; exit 1 if anything was lost, corrupt, doubled, or not said."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--kills", type=int, default=20)
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="kills-") as folder:
        tally = run(arguments.kills, arguments.seed, Path(folder))
    print("\n".join(tally.lines()))
    bad = tally.lost + tally.corrupt + tally.doubled + tally.other_tables + tally.silent
    sys.exit(1 if bad else 0)


if __name__ == "__main__":
    main()

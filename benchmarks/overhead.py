"""What tracking costs: the crossed study as a command, and the same work in plain loops.

    python benchmarks/overhead.py                 a few splits and K
    python benchmarks/overhead.py --whole         all of it: 84 splits, K 1-20, 5 step rules, 2 axes

Compared, on the recordings of data/paper_twin: a plain script with scikit-learn and gmr; the
stages' own functions in plain loops (the work); the command with its cache cold, with one setting
of the search changed, and given once more. CPU seconds are of all processes together. Plain loops
take one core and all splits take them the same time, so they go through every nth split of many,
and their seconds are scaled to all: the table says so.
"""

import argparse
import json
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path

import gmr
import numpy as np
import pandas as pd
from sklearn.mixture import GaussianMixture
from threadpoolctl import threadpool_limits

from pipeline.config import STEP_RULES, CompensationConfig, Config, CrossedConfig, TrainingConfig
from pipeline.control.trial import trial_path
from pipeline.models.loop_model import branch_samples
from pipeline.recording import Recording, load_recording
from pipeline.stages.crossed import cross, fits
from pipeline.tracking.tables import markdown

ROOT = Path(__file__).resolve().parents[1]
RECORDINGS = ROOT / "data" / "paper_twin"
AXES = ("yaw", "pitch")
GRID = 201
MOST_PLAIN_SPLITS = 12
PLAIN, OWN = "plain script, scikit-learn and gmr", "own functions in plain loops"
Search = Callable[[float, float, int], float]


@dataclass(frozen=True)
class Size:
    """How much of the study: Ks, the first splits of the 84, and how many of these plainly."""

    ks: list[int]
    splits: int
    plain_splits: int

    @property
    def searches(self) -> int:
        """K times splits times axes times step rules."""
        return len(self.ks) * self.splits * len(AXES) * len(STEP_RULES)


def plain_script(recordings: Mapping[str, Recording], size: Size) -> None:
    """The loops as one would write them with scikit-learn and gmr, without files.

    One BLAS thread, as the project has it: more make these small matrices up to ten times slower.
    """
    with threadpool_limits(1):
        _plain_loops(recordings, size)


def _plain_loops(recordings: Mapping[str, Recording], size: Size) -> None:
    targets = trial_path(CompensationConfig().targets, CompensationConfig().target_amplitude_deg)
    for test in _splits(size):
        for k in size.ks:
            for axis, recording in recordings.items():
                train = [c for c in range(9) if c not in test]
                curves = {}
                for model, s in branch_samples(recording, axis, train).items():
                    mixture = _fitted(s.command_deg, s.angle_deg, k)
                    held = branch_samples(recording, axis, test)[model]
                    _predicted(mixture, held.command_deg)
                    grid = np.linspace(s.command_deg.min(), s.command_deg.max(), GRID)
                    curves[model] = (grid, np.maximum.accumulate(_predicted(mixture, grid)))
                for step in _STEPS.values():
                    _followed(curves, targets, step)


def _fitted(
    command: np.ndarray, angle: np.ndarray, k: int
) -> tuple[gmr.GMM, np.ndarray, np.ndarray]:
    points = np.column_stack([command, angle])
    points = points[np.isfinite(points).all(axis=1)]
    centre, scale = points.mean(axis=0), points.std(axis=0)
    config = TrainingConfig()
    mixture = GaussianMixture(
        k, n_init=config.n_init, reg_covar=config.reg_covar, max_iter=config.max_iterations,
        random_state=0,
    ).fit((points - centre) / scale)  # fmt: skip
    found = gmr.GMM(k, mixture.weights_, mixture.means_, mixture.covariances_)
    return found, centre, scale


def _predicted(fitted: tuple[gmr.GMM, np.ndarray, np.ndarray], command: np.ndarray) -> np.ndarray:
    mixture, centre, scale = fitted
    standard = (command[:, None] - centre[0]) / scale[0]
    return mixture.predict(np.array([0]), standard).ravel() * scale[1] + centre[1]


_STEPS: dict[str, Search] = {
    "armijo": lambda error, slope, _: 1.0 * slope * error,
    "barzilai_borwein": lambda error, slope, n: error / slope if n else 0.5 * slope * error,
    "constant": lambda error, slope, _: 0.5 * slope * error,
    "diminishing": lambda error, slope, n: 1.5 / (n + 1) ** 0.5 * slope * error,
    "newton": lambda error, slope, _: error / slope,
}


def _followed(
    curves: Mapping[str, tuple[np.ndarray, np.ndarray]], targets: np.ndarray, step: Search
) -> None:
    command, before = 0.0, 0.0
    for target in targets:
        grid, angle = curves["cw" if target >= before else "ccw"]
        low, high, before = grid[0], grid[-1], target
        width = grid[1] - grid[0]
        for n in range(200):
            error = float(np.interp(command, grid, angle)) - target
            if abs(error) < 1e-6:
                break
            low, high = (low, command) if error > 0 else (command, high)
            ahead = float(np.interp(command + width, grid, angle)) - target
            slope = max((ahead - error) / width, 1e-3)
            command -= step(error, slope, n)
            command = command if low <= command <= high else 0.5 * (low + high)


def own_loops(recordings: Mapping[str, Recording], size: Size) -> None:
    """The work: the stages' own functions, called in loops, without files."""
    config, crossed = Config(), CrossedConfig(ks=size.ks, step_rules=list(STEP_RULES))
    for test in _splits(size):
        train = [c for c in range(9) if c not in test]
        models = dict(fits(crossed, config.training, recordings, train, config.seed))
        cross(crossed, config.compensation, config.evaluation, models, recordings, test)


def _splits(size: Size) -> list[list[int]]:
    """Of the study's splits as many as go through plain loops, evenly spread."""
    splits = [list(test) for test in combinations(range(9), 3)][: size.splits]
    return [splits[k * size.splits // size.plain_splits] for k in range(size.plain_splits)]


def command(folder: Path, name: str, size: Size, *more: str) -> None:
    """The study as one command."""
    arguments = [
        "-m", "experiment=crossed", "stages=[fits,crossed]", f"earlier={folder / 'recorded'}",
        f"crossed.ks={json.dumps(size.ks, separators=(',', ':'))}",
        f"split.index=range(0,{size.splits})", f"hydra.sweep.dir={folder / name}", *more,
    ]  # fmt: skip
    settings = {"LOOPGAP_CACHE": str(folder / "cache"), "OMP_NUM_THREADS": "1"}
    subprocess.run(
        [sys.executable, "-m", "pipeline.app", *arguments],
        cwd=ROOT, env=os.environ | settings, check=True, stdout=subprocess.DEVNULL,
    )  # fmt: skip


def stages_s(sweep: Path) -> float:
    """Seconds that the stages of a sweep's jobs ran, by their own clocks, summed."""
    documents = (json.loads(f.read_text()) for f in sweep.glob("*/provenance.json"))
    return sum(s["wall_time_s"] for d in documents for s in d["stages"] if s["made"] == "ran")


def measured(work: Callable[[], None]) -> tuple[float, float]:
    """Seconds on the clock and of the processors, children included."""

    def used_s() -> float:
        both = (resource.getrusage(w) for w in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
        return sum(usage.ru_utime + usage.ru_stime for usage in both)

    began_s, used_before_s = time.perf_counter(), used_s()
    work()
    return time.perf_counter() - began_s, used_s() - used_before_s


def compare(size: Size, folder: Path) -> pd.DataFrame:
    """A row for each way: clock, CPU, and what of it the stages were."""
    recordings = {axis: load_recording(RECORDINGS / axis) for axis in AXES}
    shutil.copytree(RECORDINGS, folder / "recorded" / "vision")
    changed = "compensation.tolerance_deg=1e-5"
    ways: Sequence[tuple[str, Callable[[], None], str | None]] = (
        ("command, cold", lambda: command(folder, "cold", size), "cold"),
        ("one setting changed", lambda: command(folder, "changed", size, changed), "changed"),
        ("new folder, nothing changed", lambda: command(folder, "same", size), "same"),
        ("same folder again", lambda: command(folder, "cold", size), None),
        (PLAIN, lambda: plain_script(recordings, size), None),
        (OWN, lambda: own_loops(recordings, size), None),
    )
    rows = []
    for name, work, sweep in ways:
        scale = size.splits / size.plain_splits if name in (PLAIN, OWN) else 1.0
        clock_s, cpu_s = (scale * seconds for seconds in measured(work))
        ran_s = stages_s(folder / sweep) if sweep else float("nan")
        rows.append({"way": name, "clock [s]": clock_s, "CPU [s]": cpu_s, "stages [s]": ran_s})
        print(f"{name}: {clock_s:.1f} s on the clock, {cpu_s:.1f} s of CPU", flush=True)
    return pd.DataFrame(rows)


def main() -> None:
    """Print the comparison, and the two ratios that the study must keep."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--ks", default="1,4,9", help="comma-separated, or 1-20")
    parser.add_argument("--splits", type=int, default=4)
    parser.add_argument("--whole", action="store_true", help="84 splits, K 1-20")
    asked = parser.parse_args()
    first, _, last = asked.ks.partition("-")
    ks = range(int(first), int(last) + 1) if last else map(int, asked.ks.split(","))
    splits = 84 if asked.whole else asked.splits
    size = Size(list(range(1, 21) if asked.whole else ks), splits, min(splits, MOST_PLAIN_SPLITS))
    with tempfile.TemporaryDirectory(prefix="overhead-") as folder:
        table = compare(size, Path(folder))
    print(f"\n{size.searches} searches: K {size.ks}, {size.splits} splits, {len(AXES)} axes, "
          f"{len(STEP_RULES)} step rules\n\n{markdown(table)}")  # fmt: skip
    if size.plain_splits < size.splits:
        print(f"Plain loops: {size.plain_splits} of {size.splits} splits, scaled to all.")
    cpu = dict(zip(table["way"], table["CPU [s]"], strict=True))
    clock = dict(zip(table["way"], table["clock [s]"], strict=True))
    work = cpu[OWN]
    print(f"tracking: {100 * (cpu['command, cold'] / work - 1):.1f} % of the work (CPU)")
    print(f"one setting changed: {clock['command, cold'] / clock['one setting changed']:.1f} times "
          f"faster than cold (clock), "
          f"{cpu['command, cold'] / cpu['one setting changed']:.1f} (CPU)")  # fmt: skip


if __name__ == "__main__":
    main()

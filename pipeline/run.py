"""One run: its stages in order, each fed from the run's folder and leaving its results there."""

import json
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import pandas as pd
from tqdm import tqdm

from pipeline.commands import SUFFIX, read_commands
from pipeline.config import Config
from pipeline.errors import UsageError, refusal
from pipeline.laboratory import Laboratory, open_laboratory
from pipeline.models.loop_model import LoopModel
from pipeline.recorder import Recorder
from pipeline.recording import Recording, load_recording, save_recording, write_atomically
from pipeline.split import split_cycles
from pipeline.stages.acquisition import acquire, channels_of, protocol
from pipeline.stages.compensation import compensate
from pipeline.stages.evaluation import evaluate, land, predict_cycles
from pipeline.stages.selection import select
from pipeline.stages.training import train
from pipeline.stages.vision import measure_angles
from pipeline.tracking import figures
from pipeline.tracking.review import AxisReview, write_review
from pipeline.tracking.tables import plain, write_table
from pipeline.vision.frames import FrameFolder

TRIAL_SEED = 1000
T = TypeVar("T")


@dataclass(frozen=True)
class Run:
    """A configuration, the folder that this run writes, and one whose results it may go on from."""

    config: Config
    folder: Path
    earlier: Path | None = None

    def find(self, name: str, stage: str) -> Path:
        """Where `name`, a result of `stage`, lies; UsageError says how to come by it."""
        for root in (self.folder, self.earlier):
            if root is not None and (root / name).exists():
                return root / name
        raise UsageError(
            refusal(str(self.folder / name), f"what the stage {stage!r} leaves", "nothing",
                    f"Add {stage!r} to `stages`, or name the run that did it: earlier=RUN_DIR.")
        )  # fmt: skip

    def measured(self) -> dict[str, Recording]:
        """The recording of every axis that has both a command and a measured angle."""
        if self.config.recording is not None:
            folders = [Path(self.config.recording)]
        else:
            folders = sorted(self.find("vision", "vision").iterdir())
        recordings = [load_recording(folder) for folder in folders]
        found = {axis: recording for recording in recordings for axis in measured_axes(recording)}
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


def run_stages(config: Config, folder: Path) -> None:
    """Run the stages that the configuration names, in their order, and say what each did."""
    run = Run(config, folder, None if config.earlier is None else Path(config.earlier))
    for number, stage in enumerate(config.stages, start=1):
        print(f"[{number}/{len(config.stages)}] {stage}", flush=True)
        began_s = time.monotonic()
        RUNNERS[stage](run)
        print(f"[{number}/{len(config.stages)}] {stage}: {time.monotonic() - began_s:.1f} s",
              flush=True)  # fmt: skip
    print(f"everything is in {folder}", flush=True)


def measured_axes(recording: Recording) -> list[str]:
    """Axes of a recording: those with a command and a measured angle."""
    commands = {c.name.removesuffix(SUFFIX) for c in recording.with_role("command")}
    measured = (c.name.removesuffix("_angle_deg") for c in recording.with_role("measurement"))
    return [axis for axis in measured if axis in commands]


def run_acquisition(run: Run) -> None:
    """Record each axis by the paper's protocol, or all axes along a file of commands."""
    config = run.config.acquisition
    if config.commands is None:
        jobs = [(axis, [axis], protocol(config, axis)) for axis in config.axes]
    else:
        table = read_commands(Path(config.commands), config.axes)
        jobs = [("commands", list(config.axes), table)]
    with open_laboratory(run.config, config.axes, run.config.seed) as laboratory:
        for name, axes, commands in jobs:
            record(run, laboratory, commands, axes, run.folder / "acquisition" / name)


def record(
    run: Run, laboratory: Laboratory, commands: pd.DataFrame, axes: Sequence[str], folder: Path
) -> None:
    """Drive along `commands` and record into `folder`; the twin's truth goes to `truth/` beside."""
    config = run.config.acquisition
    source = "real" if laboratory.truth is None else "simulated"
    cameras = {axis: laboratory.cameras[axis] for axis in axes}
    truth: list[dict[str, float]] = []
    with (
        Recorder(folder, channels_of(config), source) as recorder,
        progress_bar(f"recording {folder.name}", len(commands)) as tick,
    ):

        def look() -> None:
            if laboratory.truth is not None:
                pose = {f"{axis}_true_deg": deg for axis, deg in laboratory.truth().items()}
                truth.append({"time_s": laboratory.clock.now_s()} | pose)
            tick(1)

        try:
            acquire(
                config, commands, laboratory.robot, cameras, laboratory.clock, recorder, source,
                look,
            )  # fmt: skip
        finally:
            if truth:
                beside = _made(folder.parent / "truth")
                text = pd.DataFrame(truth).to_csv(index=False)
                write_atomically(beside / f"{folder.name}.csv", text)


def run_vision(run: Run) -> None:
    """Measure the angles in the frames of every recording that acquisition left."""
    if run.config.recording is not None:
        folders = [Path(run.config.recording)]
    else:
        parent = run.find("acquisition", "acquisition")
        folders = sorted(f for f in parent.iterdir() if (f / "recording.json").is_file())
    for folder in folders:
        see(run, folder, run.folder / "vision" / folder.name)


def see(run: Run, source: Path, target: Path) -> Recording:
    """Measure what each camera of a recording saw; markers_<axis>.csv says how."""
    recording = load_recording(source)
    axes = sorted({f.name.rsplit("_", 1)[0] for f in (source / "frames").glob("*_*.jpg")})
    if not axes:
        raise UsageError(
            refusal(str(source / "frames"), "frames <axis>_<row>.jpg", "none",
                    "Record with a camera, or leave vision out of `stages`.")
        )  # fmt: skip
    for axis in axes:
        with progress_bar(f"looking at {target.name}", len(recording.samples)) as tick:
            seen_before = 0

            def advance(done: int, _all: int, tick: Callable[[int], None] = tick) -> None:
                nonlocal seen_before
                tick(done - seen_before)
                seen_before = done

            vision = measure_angles(
                run.config.vision, recording, axis, FrameFolder(source.resolve(), axis), advance
            )
        recording = vision.recording
        target.mkdir(parents=True, exist_ok=True)
        write_atomically(target / f"markers_{axis}.csv", vision.markers.to_csv(index=False))
        lost = int(vision.markers["angle_deg"].isna().sum())
        print(f"  {target.name}, {axis}: {lost} frames without a clear pair of markers, "
              f"{int(vision.markers['outlier'].sum())} outliers flagged")  # fmt: skip
    save_recording(recording, target)
    return recording


def run_selection(run: Run) -> None:
    """Choose K for every axis and model on the training cycles."""
    recordings = run.measured()
    train_cycles, _ = run.split(recordings)
    selection = select(
        run.config.selection, run.config.training, recordings, train_cycles, run.config.seed
    )
    folder = _made(run.folder / "selection")
    write_atomically(folder / "selection.csv", selection.table.to_csv(index=False))
    write_atomically(folder / "selection.json", json.dumps(selection.chosen, indent=1))
    for axis, chosen in selection.chosen.items():
        print(f"  {axis}: " + ", ".join(f"{model} K = {k}" for model, k in chosen.items()))


def run_training(run: Run) -> None:
    """Fit nominal, cw and ccw mixtures of every axis."""
    recordings = run.measured()
    train_cycles, test_cycles = run.split(recordings)
    chosen = json.loads(run.find("selection/selection.json", "selection").read_text())
    models = train(run.config.training, recordings, train_cycles, chosen, run.config.seed)
    folder = _made(run.folder / "training")
    for axis, model in models.items():
        write_atomically(folder / f"{axis}.json", json.dumps(model.as_json(), indent=1))
    print(f"  cycles {train_cycles} train, {test_cycles} test")


def run_compensation(run: Run) -> None:
    """Commands for the trial path, with hysteresis known and without."""
    folder = _made(run.folder / "compensation")
    for axis, table in compensate(run.config.compensation, run.models()).items():
        write_atomically(folder / f"{axis}.csv", table.to_csv(index=False))


def run_evaluation(run: Run) -> None:
    """Score the models on the test cycles, then drive the robot along the compensated commands."""
    recordings, models = run.measured(), run.models()
    _, test_cycles = run.split(recordings)
    predictions = {
        axis: predict_cycles(models[axis], recording, test_cycles)
        for axis, recording in recordings.items()
    }
    landings = _trials(run) if run.config.evaluation.trial else {}
    evaluation = evaluate(run.config.evaluation, predictions, landings)
    folder = _made(run.folder / "evaluation")
    write_atomically(folder / "metrics.csv", evaluation.metrics.to_csv(index=False))
    write_table(evaluation.table, folder, "table")
    print(f"\nErrors of the models and of the robot that follows them:\n{plain(evaluation.table)}")
    if landings:
        write_table(evaluation.closed_loop, folder, "closed_loop")
        print(f"\nThe commands on the robot:\n{plain(evaluation.closed_loop)}")
    for axis, methods in landings.items():
        for method, landing in methods.items():
            write_atomically(folder / f"landing_{axis}_{method}.csv", landing.to_csv(index=False))


def _trials(run: Run) -> dict[str, dict[str, pd.DataFrame]]:
    """Each axis and method on the robot: axis -> method -> where it landed (`land`)."""
    parent = _fresh(run.folder / "evaluation", "trial")
    landings: dict[str, dict[str, pd.DataFrame]] = {}
    files = {f.stem: f for f in sorted(run.find("compensation", "compensation").glob("*.csv"))}
    for number, (axis, file) in enumerate(run.in_order(files).items()):
        table = pd.read_csv(file)
        landings[axis] = {}
        for method, solutions in table.groupby("method", sort=False):
            commands = _trial_commands(run.config, axis, solutions)
            name = f"{axis}_{method}"
            with open_laboratory(run.config, [axis], run.config.seed + TRIAL_SEED + number) as lab:
                record(run, lab, commands, [axis], parent / name)
            seen = see(run, parent / name, parent / "vision" / name)
            landings[axis][str(method)] = _landing(parent, name, axis, solutions, seen)
    return landings


def _trial_commands(config: Config, axis: str, solutions: pd.DataFrame) -> pd.DataFrame:
    """The commands that have been found, after one run around the full loop (cycle 0) and home."""
    amplitude_deg = config.acquisition.amplitude_deg[axis]
    lead_in = [amplitude_deg, -amplitude_deg, 0.0]
    sent = solutions["command_deg"].dropna().tolist()
    table = pd.DataFrame({f"{a}{SUFFIX}": 0.0 for a in config.acquisition.axes},
                         index=range(len(lead_in) + len(sent)))  # fmt: skip
    table[f"{axis}{SUFFIX}"] = lead_in + sent
    table["cycle"] = [0] * len(lead_in) + [1] * len(sent)
    table["step"] = [*range(len(lead_in)), *range(len(sent))]
    return table


def _landing(
    parent: Path, name: str, axis: str, solutions: pd.DataFrame, seen: Recording
) -> pd.DataFrame:
    """The landings of cycle 1, with the true pose where a twin knows it."""
    scored = (seen.samples["cycle"] == 1).to_numpy()
    truth_file = parent / "truth" / f"{name}.csv"
    truth = pd.read_csv(truth_file)[scored] if truth_file.is_file() else None
    return land(solutions.reset_index(drop=True), seen.cycles([1]), truth, axis)


def run_review(run: Run) -> None:
    """Figures (PNG, PDF) and one rerun recording of what the run has so far."""
    recordings, models = run.measured(), run.models()
    _, test_cycles = run.split(recordings)
    selection = pd.read_csv(run.find("selection/selection.csv", "selection"))
    chosen = json.loads(run.find("selection/selection.json", "selection").read_text())
    everything = {
        axis: predict_cycles(models[axis], r, sorted(r.samples["cycle"].unique()))
        for axis, r in recordings.items()
    }
    tested = {a: table[table["cycle"].isin(test_cycles)] for a, table in everything.items()}
    landings = _stored_landings(run)
    made = {
        "selection": figures.selection_figure(selection, chosen, run.config.selection.criterion),
        "loops": figures.loops_figure(tested),
        "errors": figures.errors_figure(tested),
    }
    if landings:
        made |= {
            "tracking": figures.tracking_figure(landings),
            "commands": figures.commands_figure(landings),
        }
    folder = _made(run.folder / "review")
    saved = {
        name: figures.save_figure(figure, _made(folder / "figures"), name)
        for name, figure in made.items()
    }
    axes = {
        axis: _axis_review(run, axis, recordings[axis], everything[axis]) for axis in recordings
    }
    pictures = {name: paths[0].read_bytes() for name, paths in saved.items()}
    write_review(folder / "run.rrd", axes, pictures, _summary(run))
    print(f"  figures: {folder / 'figures'}\n  to look through it all:  "
          f"{Path(sys.executable).parent / 'rerun'} {folder / 'run.rrd'}")  # fmt: skip


def _axis_review(
    run: Run, axis: str, recording: Recording, predictions: pd.DataFrame
) -> AxisReview:
    if run.config.recording is not None:
        frames, markers = Path(run.config.recording), pd.DataFrame()
    else:
        name = next(
            f.parent.name for f in run.find("vision", "vision").glob(f"*/markers_{axis}.csv")
        )
        frames = run.find("acquisition", "acquisition") / name
        markers = pd.read_csv(run.find("vision", "vision") / name / f"markers_{axis}.csv")
    picture = figures.loop_picture(axis, predictions)
    return AxisReview(recording, markers, FrameFolder(frames, axis).read, predictions, picture)


def _stored_landings(run: Run) -> dict[str, dict[str, pd.DataFrame]]:
    landings: dict[str, dict[str, pd.DataFrame]] = {}
    for root in (run.folder, run.earlier):
        files = sorted((root / "evaluation").glob("landing_*_*.csv")) if root else []
        for file in files:
            axis, method = file.stem.removeprefix("landing_").split("_", 1)
            landings.setdefault(axis, {}).setdefault(method, pd.read_csv(file))
    return run.in_order(landings)


def _summary(run: Run) -> str:
    parts = ["# loopgap"]
    for name in ("table", "closed_loop"):
        file = run.folder / "evaluation" / f"{name}.md"
        if file.is_file():
            parts.append(file.read_text())
    return "\n\n".join(parts)


@contextmanager
def progress_bar(title: str, total: int) -> Iterator[Callable[[int], None]]:
    """A bar on the terminal; in a plain log a line now and then."""
    with tqdm(total=total, desc=f"  {title}", mininterval=0.5, maxinterval=5.0, leave=False) as bar:
        yield lambda count: bar.update(count) and None


def _made(folder: Path) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def _fresh(parent: Path, name: str) -> Path:
    """`parent`/`name`, or with the first number behind it that isn't there yet."""
    number = 1
    while (parent / f"{name}-{number}").exists():
        number += 1
    return _made(parent / f"{name}-{number}")


RUNNERS: dict[str, Callable[[Run], None]] = {
    "acquisition": run_acquisition,
    "vision": run_vision,
    "selection": run_selection,
    "training": run_training,
    "compensation": run_compensation,
    "evaluation": run_evaluation,
    "review": run_review,
}

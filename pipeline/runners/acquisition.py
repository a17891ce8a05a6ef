"""Acquisition and vision of a run: from the robot to recordings with measured angles."""

from collections.abc import Callable, Sequence
from pathlib import Path

import pandas as pd

from pipeline.atomically import write_atomically
from pipeline.commands import read_commands
from pipeline.errors import UsageError, refusal
from pipeline.laboratory import Laboratory, open_laboratory
from pipeline.recorder import Recorder
from pipeline.recording import Recording, load_recording, save_recording
from pipeline.runners.run_folder import Run, made, progress_bar
from pipeline.stages.acquisition import acquire, channels_of, protocol
from pipeline.stages.vision import measure_angles
from pipeline.vision.frames import FrameFolder


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
                beside = made(folder.parent / "truth")
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

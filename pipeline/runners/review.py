"""Review of a run: figures and one rerun recording of what it has so far."""

import json
import sys
from pathlib import Path

import pandas as pd

from pipeline.recording import Recording
from pipeline.runners.run_folder import Run, made
from pipeline.stages.evaluation import predict_cycles
from pipeline.tracking import figures
from pipeline.tracking.review import AxisReview, write_review
from pipeline.vision.frames import FrameFolder


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
    drawn = {
        "selection": figures.selection_figure(selection, chosen, run.config.selection.criterion),
        "loops": figures.loops_figure(tested),
        "errors": figures.errors_figure(tested),
    }
    if landings:
        drawn |= {
            "tracking": figures.tracking_figure(landings),
            "commands": figures.commands_figure(landings),
        }
    folder = made(run.folder / "review")
    saved = {
        name: figures.save_figure(figure, made(folder / "figures"), name)
        for name, figure in drawn.items()
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
    root = next((r for r in run.roots("evaluation") if (r / "evaluation").is_dir()), run.folder)
    for file in sorted((root / "evaluation").glob("landing_*_*.csv")):
        axis, method = file.stem.removeprefix("landing_").split("_", 1)
        landings.setdefault(axis, {})[method] = pd.read_csv(file)
    return run.in_order(landings)


def _summary(run: Run) -> str:
    parts = ["# loopgap"]
    for name in ("evaluation/table", "evaluation/closed_loop", "diagnosis/table"):
        file = run.folder / f"{name}.md"
        if file.is_file():
            parts.append(file.read_text())
    return "\n\n".join(parts)

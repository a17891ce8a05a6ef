"""Selection, training and compensation of a run."""

import json
from collections.abc import Iterable

from pipeline.atomically import write_atomically
from pipeline.models.loop_model import MODELS
from pipeline.runners.run_folder import Run, made
from pipeline.stages.compensation import compensate
from pipeline.stages.selection import select, selection_metrics
from pipeline.stages.training import train


def run_selection(run: Run) -> None:
    """Choose K for every axis and model on the training cycles."""
    recordings = run.measured()
    train_cycles, _ = run.split(recordings)
    selection = select(
        run.config.selection, run.config.training, recordings, train_cycles, run.config.seed
    )
    folder = made(run.folder / "selection")
    write_atomically(folder / "selection.csv", selection.table.to_csv(index=False))
    metrics = selection_metrics(selection)
    write_atomically(folder / "metrics.csv", metrics.to_csv(index=False))
    write_atomically(folder / "selection.json", json.dumps(selection.chosen, indent=1))
    for axis, chosen in selection.chosen.items():
        print(f"  {axis}: " + ", ".join(f"{model} K = {k}" for model, k in chosen.items()))


def run_training(run: Run) -> None:
    """Fit nominal, cw and ccw mixtures of every axis."""
    recordings = run.measured()
    train_cycles, test_cycles = run.split(recordings)
    models = train(
        run.config.training, recordings, train_cycles, chosen_k(run, recordings), run.config.seed
    )
    folder = made(run.folder / "training")
    for axis, model in models.items():
        write_atomically(folder / f"{axis}.json", json.dumps(model.as_json(), indent=1))
    print(f"  cycles {train_cycles} train, {test_cycles} test")


def chosen_k(run: Run, axes: Iterable[str]) -> dict[str, dict[str, int]]:
    """Axis -> model -> K, as selection chose, or as the configuration fixes it."""
    if run.config.selection.k is not None:
        return {axis: dict.fromkeys(MODELS, run.config.selection.k) for axis in axes}
    return json.loads(run.find("selection/selection.json", "selection").read_text())


def run_compensation(run: Run) -> None:
    """Commands for the trial path, with hysteresis known and without."""
    folder = made(run.folder / "compensation")
    for axis, table in compensate(run.config.compensation, run.models()).items():
        write_atomically(folder / f"{axis}.csv", table.to_csv(index=False))

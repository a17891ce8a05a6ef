"""The fits of a crossed study: the models of every K on one split."""

import json

from pipeline.atomically import write_atomically
from pipeline.runners.run_folder import Run, made
from pipeline.stages.crossed import fits


def run_fits(run: Run) -> None:
    """Fit every K and leave it as fits/k-<K>.json, the models by axis."""
    recordings = run.measured()
    train_cycles, _ = run.split(recordings)
    config = run.config
    folder = made(run.folder / "fits")
    for k, models in fits(config.crossed, config.training, recordings, train_cycles, config.seed):
        text = json.dumps({axis: model.as_json() for axis, model in models.items()})
        write_atomically(folder / f"k-{k}.json", text)
    print(f"  K = {', '.join(map(str, config.crossed.ks))} on cycles {train_cycles}")

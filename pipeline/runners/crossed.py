"""The crossed study on one split: every K that was fitted, with every step rule."""

import json

from pipeline.atomically import write_atomically
from pipeline.models.loop_model import LoopModel
from pipeline.runners.run_folder import Run, made
from pipeline.stages.crossed import cross


def run_crossed(run: Run) -> None:
    """Score the fits on the test cycles and search commands with each step rule."""
    recordings = run.measured()
    _, test_cycles = run.split(recordings)
    config = run.config
    folder = run.find("fits", "fits")
    models = {
        k: {
            axis: LoopModel.from_json(entry)
            for axis, entry in json.loads((folder / f"k-{k}.json").read_text()).items()
        }
        for k in config.crossed.ks
    }
    table = cross(config.crossed, config.compensation, config.evaluation, models, recordings,
                  test_cycles)  # fmt: skip
    write_atomically(made(run.folder / "crossed") / "metrics.csv", table.to_csv(index=False))
    print(f"  {len(models)} K, {len(config.crossed.step_rules)} step rules, "
          f"cycles {test_cycles}: {len(table)} numbers")  # fmt: skip

"""One run: its stages in their order."""

import time
from collections.abc import Callable
from pathlib import Path

from pipeline.config import Config
from pipeline.runners.acquisition import run_acquisition, run_vision
from pipeline.runners.close_the_gap import run_close_the_gap
from pipeline.runners.concealed import run_concealed
from pipeline.runners.diagnosis import run_diagnosis, run_prediction
from pipeline.runners.evaluation import run_evaluation
from pipeline.runners.importing import run_importing
from pipeline.runners.models import run_compensation, run_selection, run_training
from pipeline.runners.review import run_review
from pipeline.runners.run_folder import Run

RUNNERS: dict[str, Callable[[Run], None]] = {
    "importing": run_importing,
    "acquisition": run_acquisition,
    "vision": run_vision,
    "selection": run_selection,
    "training": run_training,
    "compensation": run_compensation,
    "evaluation": run_evaluation,
    "diagnosis": run_diagnosis,
    "prediction": run_prediction,
    "review": run_review,
    "close_the_gap": run_close_the_gap,
    "concealed": run_concealed,
}


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

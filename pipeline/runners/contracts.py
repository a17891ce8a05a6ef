"""What each stage may look at and what it leaves: the ground on which results are kept and reused.

A stage is a function of the settings and files named here, of its code and of libraries; a setting
or file that is not named has no say in its result.
"""

import gc
import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from importlib import import_module
from typing import TYPE_CHECKING

from pipeline.config import Config
from pipeline.split import split_cycles

if TYPE_CHECKING:
    from pipeline.runners.run_folder import Run

FRAMES = ("acquisition/*/recording.json", "acquisition/*/samples.*", "acquisition/*/frames/*")
ANGLES = ("vision/*/recording.json", "vision/*/samples.*")
MODELS = ("training/*.json",)
COMMANDS = ("compensation/*.csv",)
CHOSEN_K = ("selection/selection.json",)
LABORATORY = ("seed", "acquisition", "robot", "camera", "twin")
IMPORTED = "recording"
NO_SAY = ("vision.workers",)


@dataclass(frozen=True)
class Contract:
    """One stage.

    `runner` is module:function, imported when the stage runs. `settings`: sections or keys of the
    configuration; `reads`: what it reads of earlier stages; `leaves`: its files and folders; all
    below the run's folder. `large`: too large to be copied into every job of a sweep.
    """

    runner: str
    settings: tuple[str, ...]
    leaves: tuple[str, ...]
    reads: tuple[str, ...] = ()
    large: bool = False

    @property
    def module(self) -> str:
        """The module whose code, with all that it imports, decides on the result."""
        return self.runner.partition(":")[0]

    def function(self) -> "Callable[[Run], None]":
        """The function that runs the stage.

        What is loaded with it stays for good: no collection of garbage need ever look at it.
        """
        module, _, name = self.runner.partition(":")
        if module not in sys.modules:
            gc.disable()
            try:
                import_module(module)
            finally:
                gc.enable()
            gc.freeze()
        return getattr(sys.modules[module], name)


_RUNNERS = "pipeline.runners."
_CONTRACTS: dict[str, Contract] = {
    "importing": Contract(f"{_RUNNERS}importing:run_importing", ("importing",), (IMPORTED,)),
    "acquisition": Contract(
        f"{_RUNNERS}acquisition:run_acquisition", LABORATORY, ("acquisition",), large=True
    ),
    "vision": Contract(
        f"{_RUNNERS}acquisition:run_vision", ("vision",), ("vision",), FRAMES, large=True
    ),
    "selection": Contract(
        f"{_RUNNERS}models:run_selection",
        ("selection", "training", "split", "seed", "acquisition.axes"),
        ("selection",),
        ANGLES,
    ),
    "training": Contract(
        f"{_RUNNERS}models:run_training",
        ("selection.k", "training", "split", "seed", "acquisition.axes"),
        ("training",),
        (*ANGLES, *CHOSEN_K),
    ),
    "compensation": Contract(
        f"{_RUNNERS}models:run_compensation",
        ("compensation", "acquisition.axes"),
        ("compensation",),
        MODELS,
    ),
    "evaluation": Contract(
        f"{_RUNNERS}evaluation:run_evaluation",
        ("evaluation", "split", "acquisition.axes"),
        ("evaluation",),
        (*ANGLES, *MODELS, *COMMANDS),
    ),
    "diagnosis": Contract(
        f"{_RUNNERS}diagnosis:run_diagnosis",
        ("simulation", "diagnosis", "acquisition.axes"),
        ("diagnosis", "diagnosis.json", "model.json", "report.html", "figures", "diagnosis.rrd",
         "next_commands*.csv"),
        ANGLES,
    ),
    "baselines": Contract(
        f"{_RUNNERS}baselines:run_baselines",
        ("simulation", "diagnosis"),
        ("baselines.*",),
        ("diagnosis.json", "diagnosis/*.csv"),
    ),
    "prediction": Contract(
        f"{_RUNNERS}diagnosis:run_prediction",
        ("recording", "model", "simulation", "diagnosis"),
        ("predictions.csv",),
    ),
    "review": Contract(
        f"{_RUNNERS}review:run_review",
        ("selection.criterion", "split", "acquisition.axes"),
        ("review",),
        (*FRAMES, "vision/*", "selection/*", *MODELS, "evaluation/*.*", "diagnosis/table.md"),
    ),
    "close_the_gap": Contract(
        f"{_RUNNERS}close_the_gap:run_close_the_gap",
        (*LABORATORY, "vision", "simulation", "diagnosis", "compensation", "evaluation",
         "close_the_gap"),
        ("round-*", "trial", "vision/*_nominal", "vision/*_compensated", "evaluation"),
    ),
    "fits": Contract(
        f"{_RUNNERS}fits:run_fits",
        ("crossed.ks", "training", "split", "seed", "acquisition.axes"),
        ("fits",),
        ANGLES,
    ),
    "crossed": Contract(
        f"{_RUNNERS}crossed:run_crossed",
        ("crossed", "compensation", "evaluation", "split", "acquisition.axes"),
        ("crossed",),
        (*ANGLES, "fits/*.json"),
    ),
    "force_study": Contract(
        f"{_RUNNERS}force_study:run_force_study",
        ("importing", "simulation", "diagnosis", "force_study"),
        ("force_study", "recordings", "diagnosis.json", "model.json", "report.html", "figures",
         "diagnosis.rrd", "next_commands*.csv"),
    ),
    "concealed": Contract(
        f"{_RUNNERS}concealed:run_concealed",
        ("diagnosis", "concealed"),
        ("cases", "truth", "results", "score"),
    ),
}  # fmt: skip


def contract_of(stage: str, config: Config) -> Contract:
    """The contract of a stage as this configuration makes it."""
    contract = _CONTRACTS[stage]
    if stage == "training" and config.selection.k is not None:
        return replace(contract, reads=ANGLES)
    if stage == "evaluation" and config.evaluation.trial:
        return replace(contract, settings=(*contract.settings, *LABORATORY, "vision"))
    return contract


def check_split(config: Config) -> None:
    """Refuse, with UsageError, a split of more cycles than will be recorded, before they are."""
    recorded = "acquisition" in config.stages and config.acquisition.commands is None
    if recorded and any("split" in contract_of(stage, config).settings for stage in config.stages):
        split_cycles(config.split, range(config.acquisition.cycles))


def may_be_reused(stage: str, config: Config) -> bool:
    """Whether the stage would do the same again: a real robot would not, nor may a user's code."""
    if stage in ("importing", "prediction", "force_study"):
        return False  # files from elsewhere, or done in less time than it takes to look
    ours = config.simulation.kind != "python" and config.simulation.path is None
    if stage in ("diagnosis", "baselines", "close_the_gap") and not ours:
        return False
    return simulated(config) or not in_laboratory(stage, config)


def in_laboratory(stage: str, config: Config) -> bool:
    """Whether the stage moves the robot."""
    trial = stage == "evaluation" and config.evaluation.trial
    return trial or stage in ("acquisition", "close_the_gap")


def simulated(config: Config) -> bool:
    """Whether the laboratory is emulated in all its parts: robot, cameras and time."""
    kinds = (config.robot.kind, config.camera.kind, config.acquisition.clock)
    return kinds == ("emulated", "twin", "simulated")

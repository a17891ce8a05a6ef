"""What of a configuration its types can't refuse."""

from operator import attrgetter

from pipeline.config import EXTRA_STAGES, STAGES, Config
from pipeline.errors import UsageError, refusal

CHOICES: dict[str, tuple[str, ...]] = {
    "acquisition.clock": ("simulated", "real"),
    "robot.kind": ("emulated", "epos2"),
    "camera.kind": ("twin", "v4l2", "folder"),
    "split.kind": ("paper", "leave_three_out", "k_fold", "explicit"),
    "selection.criterion": ("bic", "aic", "heldout"),
    "simulation.kind": ("recorded", "identity", "affine", "trace", "mechanism", "python"),
    "diagnosis.heldout.kind": ("every_third", "last_third", "after_s"),
}
LEAST = {f"diagnosis.tolerance.{name}": 0.0 for name in ("gain", "offset", "shape", "accuracy")}


def check_config(config: Config) -> None:
    """Refuse, with UsageError, names that are no choice and sizes below none."""
    for stage in config.stages:
        if stage not in (*STAGES, *EXTRA_STAGES):
            _refuse("stages", (*STAGES, *EXTRA_STAGES), stage)
    for key, choices in CHOICES.items():
        found = attrgetter(key)(config)
        if found not in choices:
            _refuse(key, choices, found)
    heldout = config.diagnosis.heldout
    if heldout.kind == "after_s" and (heldout.after_s is None or heldout.after_s <= 0.0):
        raise UsageError(
            refusal("configuration, diagnosis.heldout.after_s", "seconds after the first row",
                    repr(heldout.after_s), "Say how long a fit may look: after_s=30.")
        )  # fmt: skip
    for key, least in LEAST.items():
        size = attrgetter(key)(config)
        if not size >= least:
            raise UsageError(
                refusal(f"configuration, {key}", f"a number of at least {least:g}", repr(size),
                        "Say how far the simulation or the measurement is trusted.")
            )  # fmt: skip


def _refuse(key: str, choices: tuple[str, ...], found: str) -> None:
    expected = "one of " + ", ".join(choices)
    raise UsageError(refusal(f"configuration, {key}", expected, repr(found), "Choose one."))

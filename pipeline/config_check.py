"""What of a configuration its types can't refuse."""

import operator
from collections.abc import Callable
from operator import attrgetter

from pipeline.config import EXTRA_STAGES, STAGES, Config
from pipeline.errors import UsageError, did_you_mean, refusal

CHOICES: dict[str, tuple[str, ...]] = {
    "acquisition.clock": ("simulated", "real"),
    "robot.kind": ("emulated", "epos2"),
    "split.kind": ("paper", "leave_three_out", "k_fold", "explicit"),
    "selection.criterion": ("bic", "aic", "heldout"),
    "simulation.kind": ("recorded", "identity", "affine", "trace", "mechanism", "python"),
    "diagnosis.heldout.kind": ("every_third", "last_third", "after_s"),
}
LEAST: dict[str, float] = {
    **dict.fromkeys(
        ("selection.k", "selection.k_max", "selection.n_init", "training.n_init",
         "training.max_iterations", "compensation.max_iterations", "compensation.targets",
         "vision.workers", "close_the_gap.rounds"), 1),
    **dict.fromkeys(
        ("seed", "concealed.seed", "acquisition.pause_s", "training.reg_covar",
         "compensation.step_rule.power", "compensation.step_rule.slope_share",
         *(f"diagnosis.tolerance.{name}" for name in ("gain", "offset", "shape", "accuracy"))), 0),
}  # fmt: skip
ABOVE: dict[str, float] = dict.fromkeys(
    ("compensation.tolerance_deg", "compensation.step_rule.initial", "compensation.step_rule.step",
     "compensation.step_rule.shrink", "evaluation.tip_length_mm", "diagnosis.cutoff_hz"), 0
)  # fmt: skip
BELOW: dict[str, float] = dict.fromkeys(
    ("compensation.step_rule.shrink", "compensation.step_rule.slope_share"), 1
)


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
    _check_sizes(config, LEAST, operator.ge, "of at least")
    _check_sizes(config, ABOVE, operator.gt, "above")
    _check_sizes(config, BELOW, operator.lt, "below")


def _check_sizes(
    config: Config, bounds: dict[str, float], holds: Callable[[float, float], bool], words: str
) -> None:
    """Refuse sizes beyond a bound; what is null, or no key of the chosen step rule, has none."""
    for key, bound in bounds.items():
        group, _, name = key.rpartition(".")
        size = getattr(attrgetter(group)(config) if group else config, name, None)
        if size is not None and not holds(size, bound):
            raise UsageError(
                refusal(f"configuration, {key}", f"a number {words} {bound:g}", repr(size),
                        f"Set {key} to such a number.")
            )  # fmt: skip


def _refuse(key: str, choices: tuple[str, ...], found: str) -> None:
    expected = "one of " + ", ".join(choices)
    remedy = f"{did_you_mean(found, choices)}Choose one."
    raise UsageError(refusal(f"configuration, {key}", expected, repr(found), remedy))

"""The step rules of the inverse search, by name. A new one is a file here and a line in RULES."""

from collections.abc import Callable
from typing import Any

from pipeline.config import StepRuleConfig
from pipeline.control.step_rules.armijo import Armijo
from pipeline.control.step_rules.barzilai_borwein import BarzilaiBorwein
from pipeline.control.step_rules.base import Point, PointAt, StepRule
from pipeline.control.step_rules.constant import Constant
from pipeline.control.step_rules.diminishing import Diminishing
from pipeline.control.step_rules.newton import Newton
from pipeline.errors import UsageError, refusal

__all__ = ["RULES", "Point", "PointAt", "StepRule", "step_rule"]

RULES: dict[str, Callable[[Any], StepRule]] = {
    "armijo": Armijo,
    "barzilai_borwein": BarzilaiBorwein,
    "constant": Constant,
    "diminishing": Diminishing,
    "newton": Newton,
}


def step_rule(config: StepRuleConfig) -> StepRule:
    """A fresh step rule for one target; UsageError lists the known ones."""
    if config.name not in RULES:
        raise UsageError(
            refusal(
                "compensation.step_rule",
                f"one of {', '.join(sorted(RULES))}",
                repr(config.name),
                "Choose a step rule that exists.",
            )
        )
    return RULES[config.name](config)

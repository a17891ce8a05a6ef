"""Crossed: every K with every step rule on one split, at the level of fits, without a robot."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import pandas as pd

from pipeline.config import (
    STEP_RULES,
    CompensationConfig,
    CrossedConfig,
    EvaluationConfig,
    StepRuleConfig,
    TrainingConfig,
)
from pipeline.errors import UsageError, refusal
from pipeline.models.loop_model import MODELS, LoopModel
from pipeline.recording import Recording
from pipeline.stages.compensation import compensated_commands
from pipeline.stages.evaluation import evaluate, predict_cycles
from pipeline.stages.training import train

VARIED = ("k", "step_rule")


def fits(
    config: CrossedConfig,
    training: TrainingConfig,
    recordings: Mapping[str, Recording],
    train_cycles: Sequence[int],
    seed: int,
) -> Iterator[tuple[int, dict[str, LoopModel]]]:
    """Each K with the loop models of all axes, the same K for nominal, cw and ccw."""
    for k in config.ks:
        chosen = {axis: dict.fromkeys(MODELS, k) for axis in recordings}
        yield k, train(training, recordings, train_cycles, chosen, seed)


def cross(
    config: CrossedConfig,
    compensation: CompensationConfig,
    evaluation: EvaluationConfig,
    models: Mapping[int, Mapping[str, LoopModel]],
    recordings: Mapping[str, Recording],
    test_cycles: Sequence[int],
) -> pd.DataFrame:
    """A row for each number: `VARIED`, then those of `evaluate`.

    Errors of the models have no step rule; what a search costs has one. UsageError if a rule is
    none.
    """
    rules = {name: _rule(name) for name in config.step_rules}
    tables = []
    for k, of_axes in models.items():
        predictions = {
            axis: predict_cycles(of_axes[axis], recording, test_cycles)
            for axis, recording in recordings.items()
        }
        tables.append(evaluate(evaluation, predictions, {}).metrics.assign(k=k, step_rule=None))
        for name, rule in rules.items():
            asked = replace(compensation, step_rule=rule())
            commands = {a: {"compensated": compensated_commands(asked, m)}
                        for a, m in of_axes.items()}  # fmt: skip
            found = evaluate(evaluation, {}, {}, commands).metrics
            tables.append(found.assign(k=k, step_rule=name))
    table = pd.concat(tables, ignore_index=True)
    return table[[*VARIED, *(c for c in table if c not in VARIED)]]


def _rule(name: str) -> type[StepRuleConfig]:
    if name not in STEP_RULES:
        raise UsageError(
            refusal("crossed.step_rules", f"some of {', '.join(STEP_RULES)}", repr(name),
                    "Choose among them.")
        )  # fmt: skip
    return STEP_RULES[name]

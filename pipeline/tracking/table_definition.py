"""What a table shows: the typed form of `conf/table/*.yaml`."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from omegaconf import MISSING, OmegaConf
from omegaconf.errors import OmegaConfBaseException
from yaml import YAMLError

from pipeline.errors import UsageError, refusal

BEST = ("min", "max", "none")
TESTS = ("corrected_t", "t", "wilcoxon")


@dataclass
class ShownMetric:
    """A metric of the results, how it is shown, and whether the smallest or largest is best."""

    metric: str = MISSING
    unit: str = MISSING
    label: str = MISSING
    digits: int = 3
    best: str = "none"


@dataclass
class Comparison:
    """Each other value of a column against `baseline`, in pairs over the same replicates.

    `test_over_train` is the ratio of test to training samples, which `corrected_t` needs.
    """

    column: str = MISSING
    baseline: str = MISSING
    test: str = "corrected_t"
    test_over_train: float = 0.5


@dataclass
class TableDefinition:
    """Rows and columns: columns of the results whose values stand side by side.

    `over`: the columns whose values are the replicates of a cell. `where`: only rows with this
    value, or one of these. `best_among`: the row or column key whose values compete (the first
    column's if unset).
    """

    caption: str = MISSING
    rows: list[str] = MISSING
    columns: list[str] = field(default_factory=list)
    over: list[str] = MISSING
    metrics: list[ShownMetric] = MISSING
    where: dict[str, Any] = field(default_factory=dict)
    best_among: str | None = None
    compare: Comparison | None = None

    @property
    def keys(self) -> list[str]:
        """Row keys, then column keys."""
        return [*self.rows, *self.columns]


def read_definition(file: Path) -> TableDefinition:
    """The definition in a file; UsageError names the key that is missing, unknown or mistyped."""
    try:
        given = OmegaConf.load(file)
        whole = OmegaConf.merge(OmegaConf.structured(TableDefinition), given)
        definition = OmegaConf.to_object(whole)
    except (OSError, YAMLError, OmegaConfBaseException, ValueError) as error:
        raise UsageError(
            refusal(str(file), "the definition of a table", str(error).splitlines()[0],
                    "See docs/studies.md.")
        ) from error  # fmt: skip
    assert isinstance(definition, TableDefinition)
    for metric in definition.metrics:
        _check(file, f"best of {metric.metric}", metric.best, BEST)
    if definition.compare is not None:
        _check(file, "compare.test", definition.compare.test, TESTS)
        _check(file, "compare.column", definition.compare.column, tuple(definition.keys))
    if definition.best_among is not None:
        _check(file, "best_among", definition.best_among, tuple(definition.keys))
    return definition


def _check(file: Path, key: str, found: str, choices: tuple[str, ...]) -> None:
    if found not in choices:
        expected = f"one of {', '.join(choices)}"
        raise UsageError(refusal(f"{file}, {key}", expected, repr(found), "Choose one."))

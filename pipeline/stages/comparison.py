"""Comparison: a table of what models answer, each judged in the same ways."""

from collections.abc import Callable, Iterable, Mapping
from typing import TypeVar

import pandas as pd

Answer = TypeVar("Answer")


def comparison(
    answers: Iterable[tuple[str, Answer]], judged: Mapping[str, Callable[[Answer], float]]
) -> pd.DataFrame:
    """`model` and a column for each way of judging: a row for each model's answer, in order."""
    return pd.DataFrame(
        [
            {"model": name} | {column: error(answer) for column, error in judged.items()}
            for name, answer in answers
        ]
    )

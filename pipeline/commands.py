"""A file of commands: when each sample is due and where every commanded axis is then."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from pipeline.errors import UsageError, refusal
from pipeline.recording import CONTEXT_COLUMNS, Channel, with_context

SUFFIX = "_command_deg"


def read_commands(path: Path, axes: Sequence[str]) -> pd.DataFrame:
    """Read `acquisition.commands=FILE`: a CSV of `time_s` and `<axis>_command_deg` columns.

    Axes without a column stand at 0. `cycle` and `step` may stand in the file; where they are
    absent the command's reversals tell them. UsageError names file, row, column and remedy.
    """
    table = _read(path)
    names = [f"{axis}{SUFFIX}" for axis in axes]
    commands = [name for name in names if name in table]
    found = [str(column) for column in table]
    _check_columns(path, found, names, commands)
    for name in found:
        table[name] = _numbers(path, table, name)
    late = np.flatnonzero(np.diff(table["time_s"].to_numpy(float)) <= 0)
    if late.size:
        row = int(late[0]) + 1
        before, found = table["time_s"].iloc[row - 1], table["time_s"].iloc[row]
        raise UsageError(
            refusal(f"{path}, row {row + 2}, column 'time_s'", f"a time after {before:g} s",
                    f"{found:g} s", "Sort the rows and give each its own time.")
        )  # fmt: skip
    absent = {name: 0.0 for name in names if name not in table}
    channels = [Channel(name, "command", "deg") for name in commands]
    return with_context(table, channels).assign(**absent)


def _read(path: Path) -> pd.DataFrame:
    try:
        table = pd.read_csv(path, skipinitialspace=True)
    except (OSError, ValueError, UnicodeDecodeError) as error:
        raise UsageError(
            refusal(f"acquisition.commands={path}", "a CSV file of commands", f"{error}",
                    "Name a file with a head row, `time_s` and command columns.")
        ) from error  # fmt: skip
    if table.empty:
        raise UsageError(
            refusal(f"acquisition.commands={path}", "at least one row", "none", "Add commands.")
        )
    return table


def _check_columns(
    path: Path, found: Sequence[str], names: Sequence[str], commands: Sequence[str]
) -> None:
    where = f"acquisition.commands={path}"
    if "time_s" not in found:
        raise UsageError(
            refusal(where, "a column 'time_s'", f"columns {', '.join(found)}",
                    "Add the time [s] at which each sample is due.")
        )  # fmt: skip
    if not commands:
        raise UsageError(
            refusal(where, f"a column of {', '.join(names)}", f"columns {', '.join(found)}",
                    "Add a command, or the axis to `acquisition.axes`.")
        )  # fmt: skip
    strange = [name for name in found if name not in (*CONTEXT_COLUMNS, *names)]
    if strange:
        raise UsageError(
            refusal(where, f"no columns but {', '.join((*CONTEXT_COLUMNS, *names))}",
                    f"column {strange[0]!r}", "Remove it, or add its axis to `acquisition.axes`.")
        )  # fmt: skip


def _numbers(path: Path, table: pd.DataFrame, name: str) -> np.ndarray:
    numbers = pd.to_numeric(table[name], errors="coerce").to_numpy(float)
    whole = name in ("cycle", "step")
    good = np.isfinite(numbers)
    if whole:
        good &= (numbers >= 0) & (numbers == np.round(numbers))
    if not good.all():
        row = int(np.flatnonzero(~good)[0])
        value = table[name].iloc[row]
        found = "nothing" if pd.isna(value) else f"'{value}'"
        expected = "a whole number from 0" if whole else "a number"
        raise UsageError(
            refusal(f"{path}, row {row + 2}, column {name!r}", expected, found, "Correct it.")
        )
    return numbers.astype(int) if whole else numbers

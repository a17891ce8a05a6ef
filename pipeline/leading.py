"""Which of several commands leads: the one whose reversals part a recording into cycles."""

from collections.abc import Mapping

import numpy as np


def leading_command(
    commands: Mapping[str, np.ndarray], measurements: Mapping[str, np.ndarray]
) -> str | None:
    """The command (n,) that moves the measurements farthest, or itself where none follows any.

    measurements: (n,) each, NaN where not measured. Lines in all commands through each of them say
    by how much each command moves it, whatever their units: a voltage beside an angle travels
    nowhere. None where there is no command.
    """
    travel = {n: float(np.abs(np.diff(u)).sum()) for n, u in commands.items()}
    moving = [n for n in commands if travel[n] > 0.0]
    if len(moving) < 2:
        return max(travel, key=lambda name: travel[name]) if travel else None
    columns = np.column_stack([commands[n] - commands[n].mean() for n in moving])
    moved = np.zeros(len(moving))
    for measured in measurements.values():
        rows = np.isfinite(measured)
        if rows.sum() > len(moving) and np.ptp(measured[rows]) > 0.0:
            moved += moved_by_steps(measured[rows], columns[rows])
    way = dict(zip(moving, moved, strict=True))
    return max(moving, key=lambda n: (way[n] * travel[n], travel[n]))


def moved_by_steps(measured: np.ndarray, columns: np.ndarray) -> np.ndarray:
    """How far a step of each command (n, k) moves a measurement (n,), over its range, (k,)."""
    sizes = np.maximum(np.linalg.norm(columns, axis=0), 1e-300)
    shares = np.linalg.lstsq(columns / sizes, measured - measured.mean(), rcond=1e-9)[0]
    return np.asarray(np.abs(shares) / sizes / np.ptp(measured))

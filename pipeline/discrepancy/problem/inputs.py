"""Which command drives a signal, and by how much."""

from collections.abc import Mapping

import numpy as np

LEAST = 0.02


def input_shares(
    signal: np.ndarray, commands: Mapping[str, np.ndarray], rows: np.ndarray
) -> dict[str, float]:
    """Share of each command that moves, the largest first; they add up to 1.

    A share is |gain| times the command's standard deviation in a line through the signal (n,) over
    all commands, on the rows (n,) where the signal is known. Empty where nothing moves.
    """
    rows = rows & np.isfinite(signal)
    moving = {n: u for n, u in commands.items() if rows.any() and np.ptp(u[rows]) > 0.0}
    if not moving:
        return {}
    columns = np.column_stack([u[rows] - u[rows].mean() for u in moving.values()])
    target = signal[rows] - signal[rows].mean()
    reach = np.abs(np.linalg.lstsq(columns, target, rcond=None)[0]) * columns.std(axis=0)
    if reach.sum() == 0.0:
        return {}
    shares = zip(moving, (reach / reach.sum()).tolist(), strict=True)
    return dict(sorted(shares, key=lambda s: -s[1]))


def said_shares(shares: Mapping[str, float]) -> str:
    """`62 % by motor_0_count and 38 % by motor_1_count`; shares below 2 % are left out."""
    return " and ".join(f"{100 * s:.0f} % by {n}" for n, s in shares.items() if s >= LEAST)

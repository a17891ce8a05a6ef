"""How far a simulation is from a static curve of a command, or from one for each way of it."""

import numpy as np

from pipeline.discrepancy.problem.jumping import rising_rows

AT_TURN = 0.02


def static_misfit(command: np.ndarray, simulated: np.ndarray) -> float:
    """How far a simulation (n,) is from a static curve of a command (n,), over its range [1].

    The largest of three root mean squares: at equal commands, of each position from the line
    between its neighbours, and of positions on the way up from the middle between them and the way
    down: neighbours may all be of one way, where cycles repeat nearly. Infinite where either stands
    still.
    """
    span = float(np.ptp(simulated)) if len(simulated) else 0.0
    if len(simulated) < 3 or float(np.ptp(command)) == 0.0 or span == 0.0:
        return np.inf
    order = np.argsort(command, kind="stable")
    u, s = command[order], simulated[order]
    at, place = np.unique(u, return_inverse=True)
    mean = np.bincount(place, weights=s) / np.bincount(place)
    repeat = float(np.sqrt(np.mean((s - mean[place]) ** 2)))
    if len(at) < 5:
        return repeat / span
    left, right = at[1:-1] - at[:-2], at[2:] - at[1:-1]
    middle = (mean[:-2] * right + mean[2:] * left) / (left + right)
    beside = float(np.sqrt(np.mean((mean[1:-1] - middle) ** 2)))
    return max(repeat, beside, 0.5 * apart(command, simulated)) / span


def apart(command: np.ndarray, simulated: np.ndarray) -> float:
    """How far positions on the way up are from the line between those on the way down (RMS)."""
    rising, order = rising_rows(command), np.argsort(command, kind="stable")
    up, down = order[rising[order]], order[~rising[order]]
    if not len(down):
        return 0.0
    up = up[(command[up] >= command[down[0]]) & (command[up] <= command[down[-1]])]
    between = np.interp(command[up], command[down], simulated[down])
    return float(np.sqrt(np.mean((simulated[up] - between) ** 2))) if len(up) else 0.0


def loop_misfit(command: np.ndarray, simulated: np.ndarray) -> float:
    """The same of one loop: a curve of the command on its way up, and one on its way down.

    But for where the command turns: there both are steep.
    """
    rising, low, high = rising_rows(command), command.min(), command.max()
    near = AT_TURN * (high - low)
    within = (command > low + near) & (command < high - near)
    ways = (rising & within, ~rising & within)
    return max(static_misfit(command[way], simulated[way]) for way in ways)

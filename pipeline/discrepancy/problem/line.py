"""A line in a command: what stands for a simulation where there is none, or none that moves."""

from collections.abc import Mapping

import numpy as np

from pipeline.recording import Recording

FEWEST = 10


def own_commands(recording: Recording, measurement: str) -> dict[str, np.ndarray]:
    """The commands (n,) that may be a measurement's own: of its first name, or the only one."""
    commands = {c.name: recording.values(c.name) for c in recording.with_role("command")}
    axis = measurement.split("_")[0]
    kin = {name: u for name, u in commands.items() if name.split("_")[0] == axis}
    return kin or (commands if len(commands) == 1 else {})


def line_in_a_command(
    commands: Mapping[str, np.ndarray], measured: np.ndarray, rows: np.ndarray
) -> tuple[np.ndarray, str] | None:
    """Gain and offset of the command (n,) nearest to what was measured (n,), and its name.

    rows: (n,) mask of those to fit. None where no command moves over FEWEST of them.
    """
    best: tuple[float, np.ndarray, str] | None = None
    for name, values in commands.items():
        if rows.sum() < FEWEST or np.ptp(values[rows]) == 0.0:
            continue
        gain, offset = np.polyfit(values[rows], measured[rows], 1)
        answer = gain * values + offset
        error = float(np.mean((measured - answer)[rows] ** 2))
        if best is None or error < best[0]:
            best = error, answer, name
    return None if best is None else best[1:]

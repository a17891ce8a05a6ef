"""How close together the positions lie at which a drive was."""

import numpy as np

FINEST, FILLED = 200, 0.9


def spacing_of(drive: np.ndarray, step: float) -> float:
    """Distance between neighbouring positions of a drive (n,), no more than its usual step.

    A drive that jumps about, or comes by in other places each time, has been nearly everywhere: the
    step is halved as long as nine tenths of the range, in parts of that size, have been visited.
    """
    span = float(np.ptp(drive)) if len(drive) else 0.0
    spacing = step
    while spacing * FINEST > span > 0.0:
        parts = np.floor((drive - drive.min()) / (0.5 * spacing))
        if len(np.unique(parts)) < FILLED * 2.0 * span / spacing:
            break
        spacing *= 0.5
    return spacing

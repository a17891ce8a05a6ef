"""The path of desired angles on which an inverse is tried."""

import numpy as np


def trial_path(targets: int, amplitude_deg: float) -> np.ndarray:
    """One full back-and-forth of the angle, 0 -> +A -> 0 -> -A -> 0 [deg], shape (targets,).

    Equal steps of 4 A / targets, the last one ending at home. A robot that has been driven through
    one full cycle before is on its full loop all along this path, except right after its two turns.
    """
    phase = np.arange(1, targets + 1) / targets
    return amplitude_deg * np.interp(phase, [0.0, 0.25, 0.75, 1.0], [0.0, 1.0, -1.0, 0.0])

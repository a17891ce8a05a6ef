"""How far a drive has come since it last turned."""

import numpy as np

from pipeline.recording import reversals_of


def travelled(drive: np.ndarray) -> np.ndarray:
    """Way since the last reversal, (n,) [drive unit]; from the first sample before any."""
    turns = np.concatenate([[0], reversals_of(drive)])
    last = turns[np.searchsorted(turns, np.arange(len(drive)), side="right") - 1]
    return np.abs(drive - drive[last])

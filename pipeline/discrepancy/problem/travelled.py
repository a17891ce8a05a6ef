"""How far a drive has come since it last turned, and which samples are next to that."""

import numpy as np
from scipy.ndimage import binary_dilation

from pipeline.recording import reversals_of


def travelled(drive: np.ndarray) -> np.ndarray:
    """Way since the last reversal, (n,) [drive unit]; from the first sample before any."""
    turns = np.concatenate([[0], reversals_of(drive)])
    last = turns[np.searchsorted(turns, np.arange(len(drive)), side="right") - 1]
    return np.abs(drive - drive[last])


def about_reversals(drive: np.ndarray, within: int) -> np.ndarray:
    """Mask (n,) of samples no more than `within` from one at which a drive (n,) turns."""
    turns = np.zeros(len(drive), dtype=bool)
    turns[reversals_of(drive)] = True
    return np.asarray(binary_dilation(turns, iterations=within))

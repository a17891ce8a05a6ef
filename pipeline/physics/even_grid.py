"""The even grid that values stand on: counts of an encoder, stairs of a command."""

import numpy as np

ON_GRID, OFF_GRID = 1e-3, 0.05


def quantum_of(values: np.ndarray) -> float:
    """The step of the even grid that all finite values (n,) stand on; 0.0 where they do on none.

    The grid is the least distance of two values. It has to hold over the whole range, so that the
    rounding of a text file, which is much finer than the changes from row to row, is one too.
    """
    levels = np.unique(values[np.isfinite(values)])
    if len(levels) < 3:
        return 0.0
    apart = np.diff(levels)
    apart = apart[apart > ON_GRID * float(np.median(apart))]
    least = float(apart.min())
    steps = np.round((levels - levels[0]) / least)
    least = float((levels[-1] - levels[0]) / steps[-1])
    off = np.abs(levels - levels[0] - steps * least)
    return least if float(off.max()) < OFF_GRID * least else 0.0

"""Samples that stand off where the command turned between two of them: no frame mistook those."""

import numpy as np
from scipy.special import bdtrc

CHANCE, SHARP = 0.01, 0.3


def turned_between(drive: np.ndarray, off: np.ndarray, rows: np.ndarray, train: np.ndarray) -> bool:
    """Whether most rows (n,), a mask, stand off (n,) outwards at turns of a drive, not by chance.

    A drive that is sampled seldom turns, sets out and stops between two samples: what follows it
    has seen more of its way than is recorded, and is farther out than a straight way between the
    samples says. A marker is mistaken anywhere, in either direction. off: in the drive's direction.
    """
    bent = np.diff(drive, 2, prepend=drive[:1], append=drive[-1:])
    about = np.stack([np.roll(bent, 1), bent, np.roll(bent, -1)])
    about[0, 0] = about[2, -1] = 0.0
    sharpest = np.take_along_axis(about, np.abs(about).argmax(axis=0)[None], axis=0)[0]
    turns = np.abs(sharpest) > SHARP * np.quantile(np.abs(np.diff(drive)), 0.9)
    outward = turns & (off * sharpest < 0.0)
    count, found = int(rows.sum()), int(np.sum(outward & rows))
    if 2 * found <= count:
        return False
    return bool(bdtrc(found - 1, count, 0.5 * float(np.mean(turns[train]))) < CHANCE)

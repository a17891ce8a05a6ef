"""Single samples that stand apart from the ones before and after them."""

from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr

APART_DEVIATIONS = 7.0
NEIGHBOURS = 3
LARGEST_SHARE = 0.15
SUDDEN = 0.7


@dataclass(frozen=True)
class Spikes:
    """lone: (m,) mask of such samples. height: (m,) how far each sample is off its neighbours.

    p_value: of the highest one in as many normal errors (Bonferroni).
    """

    lone: np.ndarray
    height: np.ndarray
    p_value: float


def lone_spikes(values: np.ndarray) -> Spikes:
    """Samples off both the three before and the three after, on the same side, by 7 deviations.

    A jump that stays, a corner and a slow wave are none: they agree with one side, or with the
    very next sample. values: (m,)
    finite. Where more than 15 % stand apart, none does: that is no lone sample any more.
    """
    nothing = Spikes(np.zeros(len(values), dtype=bool), np.zeros(len(values)), 1.0)
    if len(values) < 4 * NEIGHBOURS:
        return nothing
    padded = np.concatenate([values[NEIGHBOURS:0:-1], values, values[-2 : -2 - NEIGHBOURS : -1]])
    windows = np.lib.stride_tricks.sliding_window_view(padded, NEIGHBOURS)
    middle = np.median(windows, axis=1)
    before, after = values - middle[: len(values)], values - middle[NEIGHBOURS + 1 :]
    nearer = np.where(np.abs(before) < np.abs(after), before, after)
    height = np.where(before * after > 0, nearer, 0.0)
    scale = 1.4826 * float(np.median(np.abs(np.concatenate([before, after]))))
    step = np.abs(np.diff(values, prepend=values[1], append=values[-2]))
    sudden = np.minimum(step[:-1], step[1:]) > SUDDEN * np.abs(height)
    lone = sudden & (np.abs(height) > APART_DEVIATIONS * scale)
    if scale <= 0.0 or not np.any(lone) or np.mean(lone) > LARGEST_SHARE:
        return nothing
    deviations = float(np.max(np.abs(height))) / scale
    return Spikes(lone, height, float(min(1.0, 2.0 * len(values) * ndtr(-deviations))))

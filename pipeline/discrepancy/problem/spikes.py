"""Single samples that stand apart from the ones before and after them."""

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import median_filter
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
    height, sides = off_both_sides(values, 0)
    scale = 1.4826 * float(np.median(np.abs(sides)))
    step = np.abs(np.diff(values, prepend=values[1], append=values[-2]))
    sudden = np.minimum(step[:-1], step[1:]) > SUDDEN * np.abs(height)
    lone = sudden & (np.abs(height) > APART_DEVIATIONS * scale)
    if scale <= 0.0 or not np.any(lone) or np.mean(lone) > LARGEST_SHARE:
        return nothing
    deviations = float(np.max(np.abs(height))) / scale
    return Spikes(lone, height, float(min(1.0, 2.0 * len(values) * ndtr(-deviations))))


def off_both_sides(values: np.ndarray, gap: int) -> tuple[np.ndarray, np.ndarray]:
    """How far values (m,) are off both what was before and what comes after, and from each (2, m).

    That is the median of NEIGHBOURS values on either side, with `gap` values left out between; the
    nearer side counts, and 0 where one is above and one below.
    """
    around = np.pad(values, gap + NEIGHBOURS, mode="reflect")
    middle = median_filter(around, NEIGHBOURS)[NEIGHBOURS // 2 : -(NEIGHBOURS // 2)]
    sides = values - np.stack([middle[: len(values)], middle[len(middle) - len(values) :]])
    nearer = np.where(np.abs(sides[0]) < np.abs(sides[1]), sides[0], sides[1])
    return np.where(sides[0] * sides[1] > 0, nearer, 0.0), sides

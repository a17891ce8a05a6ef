"""Samples of one clock at the moments of another, only by a rule that somebody asked for."""

from dataclasses import dataclass

import numpy as np

RULES = ("linear", "previous", "nearest")


@dataclass(frozen=True)
class Lookup:
    """For each wanted moment the rows before and after it and the share of the latter.

    Shapes (n,); `outside` marks moments before the first or after the last sample.
    """

    before: np.ndarray
    after: np.ndarray
    share: np.ndarray
    outside: np.ndarray

    def of(self, values: np.ndarray) -> np.ndarray:
        """`values` (m,) at the wanted moments, (n,); NaN outside and next to an empty sample."""
        low, high = values[self.before], values[self.after]
        mixed = np.where(self.share == 0, low, low + self.share * (high - low))
        mixed = np.where(self.share == 1, high, mixed)
        return np.where(self.outside, np.nan, mixed)

    def rows(self, rows: np.ndarray) -> np.ndarray:
        """Which of `rows` (m,) is taken at each wanted moment, -1 outside; not for `linear`."""
        return np.where(self.outside, -1, rows[np.where(self.share == 1, self.after, self.before)])


def lookup(times_s: np.ndarray, wanted_s: np.ndarray, rule: str) -> Lookup:
    """Where `wanted_s` (n,) lies among the rising `times_s` (m,), by one of RULES."""
    last = len(times_s) - 1
    before = np.clip(np.searchsorted(times_s, wanted_s, side="right") - 1, 0, last)
    after = np.minimum(before + 1, last)
    span = np.where(after == before, 1.0, times_s[after] - times_s[before])
    share = np.where(after == before, 0.0, (wanted_s - times_s[before]) / span)
    share = np.clip(share, 0.0, 1.0)
    if rule == "previous":
        share = np.where(share == 1.0, 1.0, 0.0)
    elif rule == "nearest":
        share = np.round(share)
    outside = (wanted_s < times_s[0]) | (wanted_s > times_s[-1])
    return Lookup(before, after, share, outside)

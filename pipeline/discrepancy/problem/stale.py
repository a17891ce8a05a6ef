"""Samples of a slower sensor, or of one that hangs: they say again what the one before said."""

from dataclasses import dataclass, field

import numpy as np

from pipeline.physics.even_grid import quantum_of

FEWEST, FEWEST_SHARE = 20, 0.03
BY_CHANCE, MOSTLY = 3.0, 0.5
ALONE, SCATTERED, EVEN = 1.3, 1.5, 0.4
FEWEST_HUNG, LEAP, OFTEN = 4, 4.0, 0.9


@dataclass(frozen=True)
class StaleSamples:
    """rows: (n,) samples that repeat the one before. even: whether new ones come in a rhythm.

    hung: (n,) samples at which the sensor stood still for a while, see `hung_samples`.
    """

    rows: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=bool))
    even: bool = True
    hung: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=bool))


NONE_STALE = StaleSamples()


def stale_samples(measured: np.ndarray, simulated: np.ndarray) -> StaleSamples:
    """Which samples (n,) are the one before again, to the last digit, though the motion goes on.

    Equal values are no new measurements where a sensor's noise and resolution make them much rarer
    than that: neighbouring levels of its converter, whose step is the least change where rounding
    has blurred it, would be as frequent. Where most changes are by one level, equal values are no
    more than a slow motion between two of them. They are also what a play without noise leaves at
    each turn; so new samples have to come singly among them, or they by chance among new ones.
    """
    nothing = np.zeros(len(measured), dtype=bool)
    none = StaleSamples(nothing, hung=nothing)
    known = np.flatnonzero(np.isfinite(measured) & np.isfinite(simulated))
    change = np.diff(measured[known])
    same, moving = change == 0.0, np.diff(simulated[known]) != 0.0
    count, share = int(np.sum(same & moving)), float(np.mean(same[moving])) if moving.any() else 0.0
    if count < FEWEST or not FEWEST_SHARE < share < 1.0:
        return none
    least = float(np.abs(change[~same]).min())
    near = np.abs(change) < 1.5 * max(quantum_of(levels_of(measured)), least)
    by_one = int(np.sum(near & ~same & moving))
    if count < BY_CHANCE * by_one or by_one > MOSTLY * np.sum(~same & moving):
        return none
    stretches = np.split(same, np.flatnonzero(np.diff(same)) + 1)
    again = np.array([len(s) for s in stretches if s[0]])
    new = np.array([len(s) for s in stretches if not s[0]])
    if not (new.mean() < ALONE or again.mean() < SCATTERED / (1.0 - share)):
        return none
    rows = np.zeros(len(measured), dtype=bool)
    rows[known[1:][same]] = True
    rhythm = np.diff(np.flatnonzero(~same)) if new.mean() < ALONE else new
    return StaleSamples(rows, bool(np.std(rhythm) < EVEN * np.mean(rhythm)), nothing)


def levels_of(measured: np.ndarray) -> np.ndarray:
    """The values that come more than once: a few outliers stand on no converter's level."""
    values, counts = np.unique(measured[np.isfinite(measured)], return_counts=True)
    return np.asarray(values[counts > 1])


def hung_samples(measured: np.ndarray, moving: np.ndarray) -> np.ndarray:
    """Samples (n,) of stretches at one value, to the last digit, that end in a leap.

    moving: (n,) what moves on meanwhile. What a play or dry friction holds goes on from where it
    stood; what a sensor shows that hung leaps to where the mechanism has gone: LEAP times as far as
    it otherwise changes from sample to sample while it moves on.
    """
    out = np.zeros(len(measured), dtype=bool)
    known = np.flatnonzero(np.isfinite(measured) & np.isfinite(moving))
    change, moves = np.diff(measured[known]), np.diff(moving[known]) != 0.0
    going = np.abs(change[(change != 0.0) & moves])
    if len(going) < FEWEST:
        return out
    far = LEAP * float(np.quantile(going, OFTEN))
    same = np.concatenate([[False], change == 0.0, [False]])
    edges = np.flatnonzero(np.diff(same.astype(int)))
    for first, last in zip(edges[::2], edges[1::2], strict=True):
        leaps = last < len(change) and abs(change[last]) > far
        if leaps and moves[first:last].sum() >= FEWEST_HUNG:
            out[known[first + 1 : last + 1]] = True
    return out

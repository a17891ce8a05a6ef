"""Where commands that go straight turn, set out or stop between two samples."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

STRAIGHT, MATTERS, CLEARLY, MOSTLY = 2e-4, 1e-4, 5.0, 0.5


@dataclass(frozen=True)
class Corners:
    """What commands were at k moments between samples.

    time_s, drive: (k,), in the order of time. others: the other axes' commands by name, (k,) each.
    """

    time_s: np.ndarray
    drive: np.ndarray
    others: Mapping[str, np.ndarray]


def corners_of(
    time_s: np.ndarray, drive: np.ndarray, others: Mapping[str, np.ndarray]
) -> Corners | None:
    """The corners of a drive and other commands, (n,) each, between their samples; None without."""
    own = {name: corners_in(time_s, signal) for name, signal in others.items()}
    at_drive = corners_in(time_s, drive)
    when = np.unique(np.concatenate([at_drive[0], *(when for when, _ in own.values())]))
    if not len(when):
        return None
    return Corners(
        when,
        between(time_s, drive, at_drive, when),
        {name: between(time_s, signal, own[name], when) for name, signal in others.items()},
    )


def corners_in(time_s: np.ndarray, signal: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Moments [s] and values of a signal's (n,) corners between two samples, (k,) each.

    There the lines through the two samples before and the two after meet, and the next one on each
    side is on them. What mostly bends has none, nor what is held from sample to sample.
    """
    span = float(np.ptp(signal))
    if len(signal) < 6 or span == 0.0:
        return np.zeros(0), np.zeros(0)
    i = np.arange(2, len(signal) - 3)
    before, off_before = _line(time_s, signal, i, i - 1, i - 2)
    after, off_after = _line(time_s, signal, i + 1, i + 2, i + 3)
    gap, rise = time_s[i + 1] - time_s[i], signal[i + 1] - signal[i]
    bend = before - after
    with np.errstate(divide="ignore", invalid="ignore"):
        late = (rise - after * gap) / bend
        out = np.abs(before * late - rise * late / gap)
    straight = np.maximum(off_before, off_after) < STRAIGHT * span
    if np.mean(straight) < MOSTLY:
        return np.zeros(0), np.zeros(0)
    least = np.maximum(MATTERS * span, CLEARLY * np.maximum(off_before, off_after))
    found = straight & (late > 0.0) & (late < gap) & (out > least)
    late, i = late[found], i[found]
    return time_s[i] + late, signal[i] + before[found] * late


def between(
    time_s: np.ndarray,
    signal: np.ndarray,
    corners: tuple[np.ndarray, np.ndarray],
    when: Iterable[float],
) -> np.ndarray:
    """What a signal (n,) with corners was at other moments [s]."""
    times = np.concatenate([time_s, corners[0]])
    order = np.argsort(times, kind="stable")
    values = np.concatenate([signal, corners[1]])
    return np.interp(np.asarray(when), times[order], values[order])


def _line(
    time_s: np.ndarray, signal: np.ndarray, at: np.ndarray, near: np.ndarray, far: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Slope from samples `near` to those `at`, and how far the `far` ones are from that line."""
    with np.errstate(divide="ignore", invalid="ignore"):
        slope = (signal[at] - signal[near]) / (time_s[at] - time_s[near])
    return slope, np.abs(signal[near] + slope * (time_s[far] - time_s[near]) - signal[far])

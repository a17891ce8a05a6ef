"""Holes in a recording's rows: what the drive did there nobody knows, and loops remember it."""

import numpy as np

LONG, FAR, USUAL = 5.0, 2.0, 0.95
STRAIGHT = 0.5
SETTLED = 0.8
MOST = 1.0 / 3.0


def unsettled_rows(time_s: np.ndarray, drive: np.ndarray) -> np.ndarray:
    """Rows (n,) after holes in which the drive (n,) may have turned, until that is forgotten.

    A hole is a pause LONG times as long as nearly all others, over which the drive went FAR times
    as far as it mostly steps, yet slower than it usually moves: then it turned in between. Play and
    friction forget what was, once the drive has gone over SETTLED of its range (the wiping-out
    property: Mayergoyz, Mathematical Models of Hysteresis, 1991). None where these rows would be
    more than a third of all.
    """
    out = np.zeros(len(drive), dtype=bool)
    if len(drive) < 3:
        return out
    pause_s, step = np.diff(time_s), np.abs(np.diff(drive))
    moving = (step > 0.0) & (pause_s > 0.0)
    if not moving.any():
        return out
    speed = float(np.median(step[moving] / pause_s[moving]))
    long = pause_s > LONG * float(np.quantile(pause_s, USUAL))
    leapt = step > FAR * float(np.quantile(step, USUAL))
    turned = step < STRAIGHT * speed * pause_s
    for last in np.flatnonzero(long & leapt & turned):
        out[last + 1 : last + 1 + until_wiped(drive[last + 1 :], SETTLED * np.ptp(drive))] = True
    return out if out.mean() <= MOST else np.zeros(len(drive), dtype=bool)


def until_wiped(drive: np.ndarray, span: float) -> int:
    """How many samples a drive (n,) takes until it has gone over a span; all where it never has."""
    gone = np.maximum.accumulate(drive) - np.minimum.accumulate(drive)
    wiped = np.flatnonzero(gone >= span)
    return int(wiped[0]) if len(wiped) else len(drive)

"""A command that turns between two samples: what stands off there is no mistaken frame."""

import numpy as np
import pytest
from scipy.signal import sawtooth

from pipeline.discrepancy.judgement.turned_between import turned_between
from tests.discrepancy.made import diagnosed, followed, names

FINE_S, EVERY, ROWS, LATE_S, NOISE = 0.005, 30, 900, 0.06, 0.3
SLOW_S, FAST_S = 8.0, 1.9


@pytest.fixture(scope="module")
def seldom_sampled() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Time [s], triangles, some of them fast, and what follows them late, sampled seldom."""
    time_s = FINE_S * np.arange(ROWS * EVERY)
    pace = np.where(time_s % 45.0 < 5.0, 1.0 / FAST_S, 1.0 / SLOW_S)
    drive = 30.0 * sawtooth(2.0 * np.pi * FINE_S * np.cumsum(pace), 0.5)
    followed_late, at = np.empty(len(drive)), drive[0]
    for k, asked in enumerate(drive):
        followed_late[k] = at = at + FINE_S / LATE_S * (asked - at)
    return time_s[::EVERY], drive[::EVERY], followed_late[::EVERY]


@pytest.mark.parametrize("mistaken", [0, 12])
def test_turns_that_no_sample_saw_are_no_outliers_but_mistaken_frames_are(seldom_sampled, mistaken):
    time_s, drive, late = seldom_sampled
    rng = np.random.default_rng(2)
    seen = late + NOISE * rng.standard_normal(ROWS)
    seen[rng.choice(ROWS, mistaken, replace=False)] += 4.0
    told = diagnosed(followed(time_s, drive, seen, 1.0 / SLOW_S))
    assert ("marker_outliers" in names(told)) == bool(mistaken)


def test_all_of_them_have_to_stand_off_outwards_at_a_turn():
    drive = 10.0 * np.sin(np.arange(400) / 3.0)
    peaks = np.flatnonzero((drive[1:-1] > drive[:-2]) & (drive[1:-1] > drive[2:]))[:5] + 1
    train, off = np.ones(400, dtype=bool), np.zeros(400)
    rows = np.zeros(400, dtype=bool)
    rows[peaks] = True
    off[peaks] = 2.0
    assert turned_between(drive, off, rows, train)
    assert not turned_between(drive, -off, rows, train)
    elsewhere = np.roll(rows, 4)
    assert not turned_between(drive, np.roll(off, 4), elsewhere, train)
    several = rows | np.isin(np.arange(400), [101, 141, 181, 221, 261])
    assert not turned_between(drive, np.where(several, off + (off == 0.0), off), several, train)

"""Rows that are missing: what the drive did meanwhile decides where play and friction stand."""

import numpy as np

from pipeline.config import DiagnosisConfig
from pipeline.discrepancy.problem.holes import unsettled_rows
from pipeline.recording import Recording
from pipeline.stages.diagnosis import diagnose
from tests.discrepancy.made import CHANNELS, motion_of, recorded

BEFORE, AFTER = 330, 430


def without(rows: slice, recording: Recording) -> Recording:
    samples = recording.samples
    kept = np.ones(len(samples), dtype=bool)
    kept[rows] = False
    return Recording(samples[kept].reset_index(drop=True), CHANNELS)


def test_rows_after_a_hole_do_not_count_until_the_drive_went_over_its_range() -> None:
    motion = motion_of()
    kept = np.r_[0:BEFORE, AFTER : len(motion)]
    time_s, drive = motion.time_s[kept], motion.drive[kept]
    rows = np.flatnonzero(unsettled_rows(time_s, drive))
    assert rows[0] == BEFORE
    assert np.all(np.diff(rows) == 1)
    assert 0.75 * np.ptp(drive) < np.ptp(drive[rows]) < 0.8 * np.ptp(drive)
    assert not unsettled_rows(motion.time_s, motion.drive).any()


def test_a_night_s_pause_and_a_hole_in_a_straight_way_unsettle_nothing() -> None:
    motion = motion_of()
    assert not unsettled_rows(motion.time_s + 4e4 * (motion.cycle >= 3), motion.drive).any()
    straight = np.r_[0:245, 262 : len(motion)]
    assert not unsettled_rows(motion.time_s[straight], motion.drive[straight]).any()


def test_rows_count_where_holes_would_take_most_of_them() -> None:
    motion = motion_of()
    kept = np.flatnonzero(np.arange(len(motion)) % 110 < 30)
    assert not unsettled_rows(motion.time_s[kept], motion.drive[kept]).any()


def test_friction_is_named_and_fits_behind_a_hole_and_its_rows_are_counted() -> None:
    """The loop went on in the hole, and did not leap over it as the drive's samples do."""
    whole = recorded({"friction/symmetric": {"width": 6.0, "reach": 12.0, "spread": 1.0}}, cycles=7)
    result = diagnose(DiagnosisConfig(), without(slice(BEFORE, AFTER), whole))
    found = result.diagnoses[0]
    assert [p.name for p in found.physics] == ["friction"]
    assert found.after.heldout_rmse < 1.1 * found.noise
    note = next(n for n in found.notes if "hole" in n)
    assert (
        int(note.split()[0])
        == unsettled_rows(result.evidence[0].motion.time_s, result.evidence[0].motion.drive).sum()
    )

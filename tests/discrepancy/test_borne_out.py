"""Names have to hold in held-out rows, too: what those are told far better without is not told."""

from dataclasses import replace

import numpy as np
import pytest

from pipeline.discrepancy.judgement.mistaken import follow_the_drive
from pipeline.recording import reversals_of
from tests.discrepancy.made import ANGLE, NOISE, diagnosed, explained, recorded

FRICTION = {"friction": {"width": 3.0, "reach": 2.0}}


def shifted(cycles, by):
    """Friction, and a zero that is elsewhere in some of nine cycles; 2, 5 and 8 are held out."""
    recording = recorded(FRICTION, seed=3, cycles=9)
    samples = recording.samples.copy()
    samples.loc[np.isin(samples["cycle"], cycles), ANGLE] += by
    return diagnosed(replace(recording, samples=samples)).diagnoses[0]


@pytest.mark.parametrize("by", [1.0, -2.0])
def test_a_slip_that_held_out_cycles_know_nothing_of_is_none(by):
    found = shifted([6, 7], by)
    assert {p.name for p in found.physics} == {"friction", "drift"}
    assert found.after.heldout_rmse < 0.5 * abs(by)
    assert any("lost_steps" in note and "with them in sight" in note for note in found.notes)


def test_a_slip_that_stays_is_told():
    found = shifted([7, 8], 1.0)
    assert {p.name for p in found.physics} == {"friction", "lost_steps"}
    assert not any("in sight" in note for note in found.notes)
    assert found.after.heldout_rmse < 1.2 * NOISE


def test_no_name_is_left_without_which_held_out_rows_err_far_less():
    found = shifted([7], 2.0)
    assert all(p.heldout_rmse_without > 0.7 * found.after.heldout_rmse for p in found.physics)


def test_rows_that_stand_off_after_reversals_follow_the_drive():
    recording = recorded({}, cycles=9)
    rng = np.random.default_rng(4)
    after = reversals_of(recording.values("pitch_command_deg"))[::2] + 1
    anywhere = rng.choice(len(recording.samples), len(after), replace=False)
    for rows, follow in ((after, True), (anywhere, False)):
        samples = recording.samples.copy()
        samples.loc[rows, ANGLE] += 20.0 * NOISE * rng.choice([-1.0, 1.0], len(rows))
        assert follow_the_drive(explained(replace(recording, samples=samples))) is follow

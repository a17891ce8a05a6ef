"""Residuals that swing on from sample to sample are more than noise."""

import numpy as np
import pytest

from pipeline.discrepancy.judgement.recurrence import foretold_share
from pipeline.discrepancy.judgement.structure import RECURS
from tests.discrepancy.made import ANGLE, changed, diagnosed, names, recorded

ROWS = 1000
E = np.random.default_rng(8).standard_normal(ROWS)


def test_independent_numbers_foretell_nothing():
    foretold, share = foretold_share(E)
    assert not foretold
    assert share < 0.03


def test_noise_whitened_by_a_slightly_wrong_correlation_is_noise():
    nearly = np.array([E[k] + 0.12 * (E[k - 1] if k else 0.0) for k in range(ROWS)])
    assert not foretold_share(nearly)[0]


def test_a_wave_that_loses_its_phase_is_foretold():
    phase = np.cumsum(np.full(ROWS, 0.35) + 0.1 * np.random.default_rng(9).standard_normal(ROWS))
    foretold, share = foretold_share(E + 1.2 * np.sin(phase))
    assert foretold
    assert 0.15 < share < 0.6


def test_too_few_rows_say_nothing():
    assert foretold_share(np.sin(np.arange(150) / 3.0)) == (False, 0.0)


@pytest.mark.parametrize("period_deg", [15.0, 22.0])
def test_teeth_whose_phase_walks_are_no_noise(period_deg):
    recording = recorded({}, cycles=9)
    drive = recording.values("pitch_command_deg")
    way = np.cumsum(np.abs(np.diff(drive, prepend=drive[0])))
    teeth = 0.35 * np.sin(2.0 * np.pi * drive / period_deg + way / 150.0)
    found = diagnosed(changed(recording, **{ANGLE: recording.values(ANGLE) + teeth})).diagnoses[0]
    assert found.verdict in ("unknown_physics", "partly_explained")
    assert found.unexplained.where == RECURS


def test_beside_a_rest_that_nothing_explains_no_frames_are_called_late():
    recording = recorded({"backlash": {"width": 8.0}}, cycles=9)
    drive, measured = recording.values("pitch_command_deg"), recording.values(ANGLE)
    late = np.random.default_rng(1).random(len(measured)) < 0.05
    stale = np.where(late, np.roll(measured, 1), measured)
    way = np.cumsum(np.abs(np.diff(drive, prepend=drive[0])))
    teeth = 0.35 * np.sin(2.0 * np.pi * drive / 22.0 + way / 150.0)
    named = {
        rest: names(diagnosed(changed(recording, **{ANGLE: stale + rest * teeth})))
        for rest in (0.0, 1.0)
    }
    assert named == {0.0: {"backlash", "frame_lag"}, 1.0: {"backlash"}}

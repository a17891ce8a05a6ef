"""Recordings and simulations that few would make: an honest verdict, or a clear refusal."""

from dataclasses import replace

import numpy as np
import pytest

from pipeline.discrepancy.model.result import VERDICTS
from pipeline.discrepancy.problem.driven import DiagnosisError
from pipeline.physics.catalogue import BENDS
from tests.discrepancy.made import ANGLE, NOISE, SIMULATED, changed, diagnosed, names, recorded


@pytest.mark.parametrize("factor", [10.0, 0.1, -1.0])
def test_a_wrong_factor_is_no_calibration_and_hides_no_play(factor):
    recording = recorded({"backlash": {"width": 4.0}}, seed=1)
    scaled = changed(recording, **{SIMULATED: factor * recording.values(SIMULATED)})
    diagnosis = diagnosed(scaled).diagnoses[0]
    assert [p.name for p in diagnosis.physics] == ["backlash"]
    assert diagnosis.verdict == "partly_explained"
    assert "gain" in diagnosis.unexplained.where
    assert diagnosis.after.heldout_rmse < 1.15 * NOISE


def test_a_perfect_simulation_is_no_mismatch():
    recording = recorded({}, noise=0.0)
    exact = changed(recording, **{ANGLE: recording.values(SIMULATED)})
    diagnosis = diagnosed(exact).diagnoses[0]
    assert diagnosis.verdict == "no_mismatch"
    assert diagnosis.after.heldout_rmse < 1e-3


def test_a_constant_command_names_nothing_that_moves():
    recording = recorded({}, seed=2)
    still = changed(
        recording,
        pitch_command_deg=0.0,
        **{SIMULATED: 0.0, ANGLE: recording.values(ANGLE) - recording.values(SIMULATED)},
    )
    diagnosis = diagnosed(still).diagnoses[0]
    assert "backlash" in diagnosis.not_excited


def test_a_simulation_that_does_not_move_gives_way_to_a_line():
    recording = recorded({"backlash": {"width": 6.0}}, seed=4)
    diagnosis = diagnosed(changed(recording, **{SIMULATED: 0.0})).diagnoses[0]
    found = {p.name: p for p in diagnosis.physics}
    width = found["backlash"].parameters[0]
    assert width.value == pytest.approx(6.0, abs=0.5)
    assert diagnosis.before.heldout_rmse > 20.0
    assert diagnosis.after.heldout_rmse < 1.2 * NOISE
    assert any("does not move" in note for note in diagnosis.notes)
    noise = recording.values(ANGLE) - recording.values(ANGLE).mean()
    noise = np.random.default_rng(5).permutation(noise) * NOISE / np.std(noise)
    nothing = diagnosed(changed(recording, **{SIMULATED: 0.0, ANGLE: noise})).diagnoses[0]
    assert nothing.verdict == "no_mismatch"


@pytest.mark.parametrize("rows", [slice(0, 120), slice(0, 240), slice(0, 90)])
def test_few_cycles_give_an_answer(rows):
    recording = recorded({"backlash": {"width": 6.0}}, seed=3)
    short = replace(recording, samples=recording.samples.iloc[rows].reset_index(drop=True))
    diagnosis = diagnosed(short).diagnoses[0]
    assert diagnosis.verdict in VERDICTS
    assert diagnosis.after.heldout_rmse < diagnosis.before.heldout_rmse


def test_bursts_of_missing_frames_are_counted():
    recording = recorded({"backlash": {"width": 4.0}}, seed=9)
    angle = recording.values(ANGLE).copy()
    for begin in range(20, 700, 90):
        angle[begin : begin + 35] = np.nan
    result = diagnosed(changed(recording, **{ANGLE: angle}))
    assert "backlash" in names(result)
    assert any("were not measured" in note for note in result.diagnoses[0].notes)


def test_two_samples_are_refused():
    recording = recorded({})
    short = replace(recording, samples=recording.samples.iloc[:2])
    with pytest.raises(Exception, match=r"at least 40 samples for a diagnosis; found 2"):
        diagnosed(short)


@pytest.mark.parametrize("channel", [ANGLE, SIMULATED])
def test_a_measurement_of_which_nothing_was_measured_or_simulated_is_refused(channel):
    recording = recorded({})
    empty = changed(recording, **{channel: np.full(len(recording.samples), np.nan)})
    with pytest.raises(DiagnosisError, match=r"measured, and simulated; found none in 720 rows"):
        diagnosed(empty)


def test_a_sensor_and_a_simulation_that_both_stand_still_are_refused():
    recording = recorded({})
    still = changed(recording, **{ANGLE: 1.0, SIMULATED: 1.0})
    with pytest.raises(DiagnosisError, match="its simulation moves; found 1 in all 720 rows"):
        diagnosed(still)


@pytest.mark.parametrize(("scale", "found"), [(1e160, "numbers up to"), (1e-14, "differ by")])
@pytest.mark.parametrize("channel", [ANGLE, SIMULATED, "pitch_command_deg"])
def test_numbers_that_can_not_be_reckoned_with_are_refused(channel, scale, found):
    recording = recorded({})
    other = changed(recording, **{channel: scale * recording.values(channel)})
    with pytest.raises(DiagnosisError, match=rf"'{channel}': expected .*{found}"):
        diagnosed(other)


def test_a_measurement_without_simulation_is_refused():
    recording = recorded({})
    bare = replace(recording, channels=recording.channels[:3])
    with pytest.raises(DiagnosisError, match=r"a simulation channel of it; found none"):
        diagnosed(bare)


def test_a_simulation_that_stands_still_gives_way_to_a_line_beside_which_the_curve_bends():
    recording = recorded({}, seed=16)
    (found,) = diagnosed(changed(recording, **{SIMULATED: 0.0})).diagnoses
    (bend,) = found.physics
    assert found.verdict == "ambiguous"
    assert {bend.name, *bend.alternatives} == BENDS
    assert "does not move: a line in pitch_command_deg" in found.notes[0]
    assert found.before.heldout_rmse > 20.0

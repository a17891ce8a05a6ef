"""A zero that is another one in each cycle: noise, drift, or a slip."""

import numpy as np
import pytest

from pipeline.discrepancy.fitting.ground import ground_of
from pipeline.discrepancy.judgement.cycle_zero import stepped, wanders_by_cycle
from pipeline.discrepancy.noise.noise import NoiseModel
from tests.discrepancy.made import (
    ANGLE,
    NOISE,
    SIMULATED,
    changed,
    chosen,
    diagnosed,
    names,
    posed,
    recorded,
    value_of,
)


@pytest.mark.parametrize(("seed", "step"), [(228, 0.005), (501, 0.0025), (547, 0.012)])
def test_a_zero_that_walks_is_no_drift_until_that_is_likelier(seed, step):
    recording = recorded({}, seed=seed, cycles=9)
    rng = np.random.default_rng(7000 + seed)
    walk = np.cumsum(rng.normal(0.0, step, len(recording.values(ANGLE))))
    result = diagnosed(changed(recording, **{ANGLE: recording.values(ANGLE) + walk}))
    assert result.diagnoses[0].verdict == "no_mismatch"


@pytest.mark.parametrize(("size", "found"), [(0.1, set()), (0.5, {"drift"}), (4.0, {"drift"})])
def test_a_zero_that_wanders_from_cycle_to_cycle_is_a_drift_where_it_exceeds_the_noise(size, found):
    whole = recorded({}, cycles=9, seed=5)
    walk = size * np.cumsum([0.0, 1.0, -1.5, -1.0, 2.0, 0.5, -1.5, 1.5, 0.5])
    angle = whole.samples[ANGLE] + walk[whole.samples["cycle"]]
    result = diagnosed(changed(whole, **{ANGLE: angle}))
    assert names(result) == found
    assert result.diagnoses[0].verdict == ("explained" if found else "no_mismatch")
    if found:
        deviation = value_of(result, "drift", "deviation")
        assert deviation.low < np.std(walk, ddof=1) < deviation.high
        assert result.diagnoses[0].noise == pytest.approx(NOISE, rel=0.1)


@pytest.mark.parametrize(
    ("jump", "zeros", "wanders"),
    [(5.0, 5.0, True), (5.0, 1.0, False), (80.0, 5.0, False)],
    ids=["both", "hardly", "a slip that zeros take back"],
)
def test_beside_slips_a_zero_wanders_that_does_by_much_and_takes_none_of_them_back(
    jump, zeros, wanders
):
    recording = recorded({"lost_steps": {"jump": 5.0, "time": 1000.0}}, cycles=9, seed=5)
    off = zeros * NOISE * np.array([0.0, 1.0, -1.5, -0.5, 1.2, 0.4, -1.5, 1.5, 0.5])
    cycle = recording.values("cycle").astype(int)
    problem = posed(changed(recording, **{ANGLE: recording.values(ANGLE) + off[cycle]}))
    noise = NoiseModel(white=NOISE, jitter=zeros * NOISE)
    ground = ground_of(problem, noise, problem.train)
    assert wanders_by_cycle(chosen(ground, 0.0, lost_steps=[jump, 1000.0])) == wanders


@pytest.mark.parametrize(("size", "found"), [(0.2, set()), (1.0, {"drift"})])
def test_of_few_cycles_a_zero_has_to_wander_by_much_more_and_may_have_slipped(size, found):
    whole = recorded({}, cycles=4, seed=5)
    zeros = size * np.array([0.0, 1.2, -0.3, -1.0])
    angle = whole.samples[ANGLE] + zeros[whole.samples["cycle"]]
    result = diagnosed(changed(whole, **{ANGLE: angle}))
    assert names(result) == found
    for physics in result.diagnoses[0].physics:
        assert physics.alternatives == ("lost_steps",)


def test_a_slip_in_a_held_out_cycle_is_not_refuted_by_that_cycle():
    result = diagnosed(recorded({"lost_steps": {"jump": 5.0, "time": 1000.0}}, seed=11))
    assert names(result) == {"lost_steps"}
    assert result.diagnoses[0].verdict == "explained"


def test_a_gain_that_changes_from_cycle_to_cycle_is_no_physics_of_ours():
    recording = recorded({}, seed=12)
    worn = 1.0 - 0.02 * recording.values("cycle") * (recording.values(ANGLE) > 0)
    result = diagnosed(changed(recording, **{ANGLE: recording.values(ANGLE) * worn}))
    assert result.diagnoses[0].verdict in ("unknown_physics", "partly_explained")
    assert len(names(result)) <= 1


def test_a_zero_that_jitters_about_as_much_as_the_noise_is_noise():
    recording = recorded({}, seed=400, cycles=9)
    zeros = np.random.default_rng(400).normal(0.0, NOISE, 9)
    off = zeros[recording.values("cycle").astype(int)]
    result = diagnosed(changed(recording, **{ANGLE: recording.values(ANGLE) + off}))
    assert result.diagnoses[0].verdict == "no_mismatch"


def test_zeros_at_two_levels_one_after_the_other_may_be_a_slip():
    recording = recorded({}, seed=401, cycles=9)
    zeros = np.random.default_rng(1).normal(0.0, 0.06, 9) + 0.7 * (np.arange(9) > 2)
    off = zeros[recording.values("cycle").astype(int)]
    (found,) = diagnosed(changed(recording, **{ANGLE: recording.values(ANGLE) + off})).diagnoses
    (physics,) = found.physics
    assert (physics.name, physics.alternatives) == ("drift", ("lost_steps",))
    assert found.verdict == "ambiguous"
    assert not stepped(np.array([0.1, -0.6, 0.5, 0.9, -0.4, 0.2]))


def test_a_zero_that_is_far_off_draws_no_names():
    diagnosis = diagnosed(recorded({"backlash": {"width": 4.0}}, seed=15, offset=400.0))
    (found,) = diagnosis.diagnoses
    assert names(diagnosis) == {"backlash"}
    assert found.calibration.offset == pytest.approx(400.0, abs=0.1)
    assert found.verdict == "partly_explained"
    assert "offset" in found.unexplained.where


def test_a_zero_that_wanders_under_a_constant_command_is_drift():
    recording = recorded({}, seed=14)
    off = recording.values(ANGLE) - 1.02 * recording.values(SIMULATED)
    still = changed(
        recording,
        pitch_command_deg=0.0,
        **{SIMULATED: 0.0, ANGLE: off + 3.0 * recording.values("time_s") / 3600.0},
    )
    result = diagnosed(still)
    assert names(result) == {"drift"}
    assert result.diagnoses[0].verdict == "explained"

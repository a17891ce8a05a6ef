"""Several commands, uneven sampling, responses that swing: recovered from made recordings."""

import json
from dataclasses import replace

import numpy as np
import pytest

from pipeline.config import DiagnosisConfig, HeldoutConfig, ToleranceConfig
from pipeline.discrepancy.fitting.fit import evaluate, improve
from pipeline.discrepancy.fitting.ground import ground_of
from pipeline.discrepancy.model.model import ModelError, as_json, from_json
from pipeline.discrepancy.noise.noise import NoiseModel
from pipeline.discrepancy.problem.inputs import input_shares, said_shares
from pipeline.physics.coupling import Coupling
from pipeline.physics.kinematics import CubicCurve
from pipeline.physics.mechanism import Mechanism
from pipeline.physics.motion import Motion
from pipeline.physics.piece import Piece
from pipeline.physics.second_order_lag import SecondOrderLag
from pipeline.recording import Recording
from pipeline.stages.diagnosis import diagnose
from pipeline.stages.prediction import predict
from tests.discrepancy.made import CHANNELS, NOISE, posed, recorded

ANGLE, SIMULATED, YAW = "pitch_angle_deg", "pitch_angle_sim_deg", "yaw_command_deg"


def test_a_coupling_through_a_wire_with_play_is_recovered():
    hidden = {f"coupling/{YAW}/play": {"gain": 0.15, "drag": -0.15, "width": 12.0}}
    (diagnosis,) = diagnose(DiagnosisConfig(), recorded(hidden, seed=4, two_axes=True)).diagnoses
    (physics,) = diagnosis.physics
    assert physics.name == "coupling"
    found = {e.name: e.value for e in physics.parameters}
    assert found["gain"] == pytest.approx(0.153, rel=0.05)
    assert found["drag"] == pytest.approx(-0.153, rel=0.15)
    assert found["width"] == pytest.approx(12.0, rel=0.15)
    assert diagnosis.after.heldout_rmse < 1.1 * NOISE
    assert "yaw_command_deg" in physics.says


def test_a_coupling_that_turns_what_the_joint_stands_on_draws_no_other_name():
    hidden = {f"coupling/{YAW}/direct": {"gain": 0.25, "bend": 2e-3}}
    (diagnosis,) = diagnose(DiagnosisConfig(), recorded(hidden, seed=4, two_axes=True)).diagnoses
    (physics,) = diagnosis.physics
    assert (physics.name, diagnosis.verdict) == ("coupling", "explained")
    found = {e.name: e.value for e in physics.parameters}
    assert found["gain"] == pytest.approx(0.255, rel=0.05)
    assert found["bend"] == pytest.approx(2.04e-3, rel=0.1)


def test_a_coupling_by_the_square_of_the_other_command_is_recovered():
    hidden = {f"coupling/{YAW}": {"gain": 0.0, "bend": 4e-3}}
    (diagnosis,) = diagnose(DiagnosisConfig(), recorded(hidden, seed=4, two_axes=True)).diagnoses
    (physics,) = diagnosis.physics
    assert (physics.name, diagnosis.verdict) == ("coupling", "explained")
    found = {e.name: e.value for e in physics.parameters}
    assert found["bend"] == pytest.approx(4.08e-3, rel=0.1)
    assert "of its square" in physics.says


def test_a_coupling_that_is_no_load_leaves_a_slack_joint_where_it_hangs():
    hidden = {
        f"coupling/{YAW}/direct": {"gain": 0.1},
        "slack/home": {"width": 4.0, "rounding": 0.1},
    }
    (diagnosis,) = diagnose(DiagnosisConfig(), recorded(hidden, seed=4, two_axes=True)).diagnoses
    assert {p.name for p in diagnosis.physics} == {"coupling", "slack"}
    assert diagnosis.verdict == "explained"
    found = {e.name: e.value for p in diagnosis.physics for e in p.parameters}
    assert found["width"] == pytest.approx(4.0, rel=0.05)


def test_what_turns_the_mount_does_so_wherever_the_curve_is():
    motion = Motion(np.full(9, 40.0), np.arange(9.0), np.zeros(9, dtype=int), {YAW: np.arange(9.0)})
    turned = Piece(Coupling(f"{YAW}/direct"), np.array([0.5, 0.1]))
    answer = Mechanism(CubicCurve(0.7, 1e-4), (turned,)).respond(motion)[0]
    assert answer[8] - answer[0] == pytest.approx(4.0 + 6.4, abs=1e-9)


def test_a_wire_that_only_drags_along_pushes_by_no_more_than_its_half_width():
    yaw = np.concatenate([np.linspace(0, 30, 40), np.linspace(30, -30, 80)])
    motion = Motion(np.zeros(120), np.arange(120.0), np.zeros(120, dtype=int), {YAW: yaw})
    drag = Piece(Coupling(f"{YAW}/play"), np.array([0.0, 0.0, 0.5, 8.0]))
    answer = Mechanism(pieces=(drag,)).respond(motion)[0]
    assert answer[39] == pytest.approx(0.5 * 4.0, abs=1e-6)
    assert answer[-1] == pytest.approx(-0.5 * 4.0, abs=1e-6)


def test_which_command_drives_what_is_found_and_said():
    rng = np.random.default_rng(0)
    commands = {"a": rng.standard_normal(400), "b": 10.0 * rng.standard_normal(400)}
    signal = 3.0 * commands["a"] - 0.1 * commands["b"]
    signal[:50] = np.nan
    shares = input_shares(signal, commands | {"still": np.ones(400)}, np.ones(400, dtype=bool))
    assert said_shares(shares) in ("75 % by a and 25 % by b", "74 % by a and 26 % by b",
                                   "76 % by a and 24 % by b")  # fmt: skip
    assert sum(shares.values()) == pytest.approx(1.0)


def swinging(keep: np.ndarray, jitter: float) -> Recording:
    """Answers of w = 3 rad/s and damping 0.3 to commands that run for half of each dwell.

    Sampled about every 0.2 s, on some rows.
    """
    rng = np.random.default_rng(2)
    n = 900
    time_s = np.cumsum(0.2 * (1.0 + jitter * rng.uniform(-1, 1, n)))
    command = 20.0 * np.sign(np.sin(2 * np.pi * np.arange(n) / 60.0)) + 10.0 * np.sin(time_s / 9.0)
    motion = Motion(command, time_s, np.arange(n) // 60)
    truth = Mechanism(pieces=(Piece(SecondOrderLag(), np.array([3.0, 0.3, 0.5])),))
    answer = truth.respond(motion)[0] + 0.05 * rng.standard_normal(n)
    samples = recorded({}, cycles=8).samples.iloc[:n].copy()
    measured = {ANGLE: np.where(keep, answer, np.nan), SIMULATED: command}
    samples = samples.assign(
        time_s=time_s, cycle=motion.cycle, pitch_command_deg=command, **measured
    )
    return Recording(samples, CHANNELS)


@pytest.mark.parametrize(("share", "jitter"), [(1.0, 0.0), (1.0, 0.8), (0.6, 0.8)])
def test_a_swing_is_the_same_whether_sampled_evenly_or_not(share, jitter):
    keep = np.random.default_rng(3).uniform(size=900) < share
    recording = swinging(keep, jitter)
    problem = posed(recording)
    ground = ground_of(problem, NoiseModel(0.05), problem.train)
    physics = SecondOrderLag()
    starts = physics.candidates(problem.motion, problem.around)
    begun = min((evaluate(ground, (Piece(physics, v),)) for v in starts), key=lambda f: f.cost)
    fit = improve(begun, 30)
    assert fit.pieces[0].values[:2] == pytest.approx([3.0, 0.3], rel=0.02)
    assert fit.pieces[0].values[2] == pytest.approx(0.5, abs=0.1)


def test_first_and_second_order_agree_where_the_swing_is_dead():
    motion = Motion(np.ones(50), np.linspace(0.0, 10.0, 50), np.zeros(50, dtype=int))
    state = {"response_lag/second": np.array([0.0, 0.0, 0.0, 1.0])}
    heavy = Mechanism(pieces=(Piece(SecondOrderLag(), np.array([100.0, 50.0, 0.0])),))
    answer = heavy.respond(motion, state)[0]
    assert answer == pytest.approx(1.0 - np.exp(-motion.time_s), abs=2e-3)


@pytest.mark.parametrize("damping", [0.3, 2.0])
def test_a_command_that_runs_is_followed_as_by_many_short_steps(damping):
    time_s = np.arange(40.0)
    command = np.random.default_rng(4).uniform(-5.0, 5.0, 40)
    values = np.array([1.3, damping, 0.6])
    motion = Motion(command, time_s, np.zeros(40, dtype=int))
    whole = Mechanism(pieces=(Piece(SecondOrderLag(), values),)).respond(motion)[0]
    fine_s = np.arange(0.0, 39.0005, 1e-3)
    part = np.clip((fine_s % 1.0) / 0.6, 0.0, 1.0)
    k = np.minimum(fine_s.astype(int), 38)
    stepped = command[k] + (command[k + 1] - command[k]) * part
    stepped[-1] = command[39]
    fine = Motion(stepped, fine_s, np.zeros(len(fine_s), dtype=int))
    values = np.array([1.3, damping, 0.0])
    answer = Mechanism(pieces=(Piece(SecondOrderLag(), values),)).respond(fine)[0]
    np.testing.assert_allclose(whole, answer[::1000], atol=0.02)


def test_a_mismatch_below_the_declared_accuracy_is_none():
    recording = recorded({"backlash": {"width": 2.0}}, seed=3)
    tolerance = ToleranceConfig(accuracy=1.0)
    config = DiagnosisConfig(tolerance, HeldoutConfig("last_third"))
    (diagnosis,) = diagnose(config, recording).diagnoses
    assert diagnosis.verdict == "no_mismatch"
    assert diagnosis.physics == ()
    assert any("Within that accuracy backlash may be hidden" in note for note in diagnosis.notes)
    strict = replace(config, tolerance=replace(tolerance, accuracy=0.3))
    assert diagnose(strict, recording).diagnoses[0].physics[0].name == "backlash"


def test_what_repeats_below_the_declared_accuracy_is_corrected_and_bears_no_name():
    recording = recorded({f"coupling/{YAW}": {"gain": 0.03}}, seed=3, two_axes=True)
    config = DiagnosisConfig(ToleranceConfig(accuracy=1.0), HeldoutConfig("last_third"))
    result = diagnose(config, recording)
    (diagnosis,), (model,) = result.diagnoses, result.models
    assert (diagnosis.verdict, diagnosis.physics) == ("no_mismatch", ())
    assert diagnosis.calibration.gain == pytest.approx(1.02, abs=0.01)
    assert diagnosis.calibration.offset == pytest.approx(0.4, abs=0.1)
    assert diagnosis.calibration.smooth_error == pytest.approx(0.03 * 30.0 / np.sqrt(2.0), rel=0.1)
    assert diagnosis.after.heldout_rmse < 1.1 * NOISE
    assert not any("may be hidden" in note for note in diagnosis.notes)
    stored = json.loads(json.dumps(as_json(model)))
    answer = predict([from_json(stored, [YAW])], recording)[f"{ANGLE}_predicted"]
    assert answer.to_numpy() == pytest.approx(result.evidence[0].after)
    with pytest.raises(ModelError, match="command 'yaw_command_deg'"):
        from_json(stored, [])


def test_what_does_not_repeat_below_the_declared_accuracy_is_left_in():
    rng = np.random.default_rng(8)
    recording = recorded({}, seed=8, two_axes=True)
    walk = recording.values(ANGLE) + 0.05 * np.cumsum(rng.normal(size=len(recording.samples)))
    samples = recording.samples.assign(**{ANGLE: walk})
    config = DiagnosisConfig(ToleranceConfig(accuracy=5.0), HeldoutConfig("last_third"))
    (diagnosis,) = diagnose(config, Recording(samples, CHANNELS, "simulated")).diagnoses
    assert diagnosis.verdict == "no_mismatch"
    assert diagnosis.calibration.gain == pytest.approx(1.02, abs=0.02)
    mean = np.mean((walk - 1.02 * recording.values(SIMULATED))[diagnosis_rows(recording)])
    assert diagnosis.calibration.offset == pytest.approx(mean, abs=0.1)


def diagnosis_rows(recording: Recording) -> slice:
    """The rows that are fitted where the last third is held out, from the first reversal on."""
    return slice(30, len(recording.samples) * 2 // 3)

"""What the catalogue has no name for, yet is known: worn play, jerks, a quiet hum."""

import numpy as np
import pytest

from pipeline.discrepancy.fitting.fit import evaluate
from pipeline.discrepancy.fitting.ground import ground_of
from pipeline.discrepancy.judgement.hum import hum
from pipeline.discrepancy.judgement.structure import JERKS, SWINGS
from pipeline.discrepancy.noise.noise import NoiseModel
from pipeline.discrepancy.search import explain
from pipeline.discrepancy.search.counted import leaping
from pipeline.discrepancy.search.polish import polished
from pipeline.discrepancy.search.weighing import Choice
from pipeline.physics.kinematics import CubicCurve
from pipeline.physics.motion import Motion
from pipeline.physics.piece import Piece
from pipeline.physics.play_operator import play, varying_play
from pipeline.physics.running_clock import RunningClock
from pipeline.physics.single_bump import SingleBump
from pipeline.physics.snapping_joint import CURVED, SnappingJoint
from pipeline.physics.uneven_play import OPENING, UnevenPlay
from pipeline.physics.worn_play import WornPlay
from pipeline.recording import Recording
from tests.discrepancy.made import (
    ANGLE,
    NOISE,
    SIMULATED,
    changed,
    diagnosed,
    explained,
    followed,
    names,
    posed,
    recorded,
)

SHAPES = {
    "wide at two places": lambda u: 1.5 + 4.0 * np.exp(-(((np.abs(u) - 28.0) / 10.0) ** 2)),
    "wide at one end": lambda u: 1.0 + 5.0 * ((u + 55.0) / 110.0) ** 4,
    "wide beyond an edge": lambda u: 1.0 + 5.0 / (1.0 + np.exp(-(u - 10.0) / 6.0)),
}


def moved(hidden: np.ndarray, seed: int = 0) -> Recording:
    """A recording in which a motor stands there (n,) instead of where it was told."""
    plain = recorded({}, seed=seed)
    noise = NOISE * np.random.default_rng(seed).standard_normal(len(hidden))
    return changed(plain, **{ANGLE: CubicCurve(0.7, 1e-5)(hidden) + noise})


def period_of(where: str) -> float:
    """The period [s] of the hum that is told."""
    assert where.startswith("a hum in time, again and again every ")
    return float(where.split()[-2])


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.long
def test_play_that_differs_from_place_to_place_is_play_and_more_than_that(shape):
    command = recorded({}).values("pitch_command_deg")
    result = diagnosed(moved(varying_play(command, 0.5 * SHAPES[shape](command), command[0])))
    (found,) = result.diagnoses
    assert names(result) == {"backlash"}
    assert not found.physics[0].alternatives
    assert found.verdict == "partly_explained"
    opens = shape != "wide at two places"
    assert found.unexplained.where == (UnevenPlay(OPENING) if opens else WornPlay()).beyond
    assert 0.0 < found.unexplained.share < 1.0
    assert found.unexplained.p_value < 1e-6
    assert found.after.heldout_rmse < 1.25 * NOISE < found.before.heldout_rmse


def test_play_of_one_width_is_no_more_than_that():
    command = recorded({}).values("pitch_command_deg")
    result = diagnosed(moved(play(command, 2.0, command[0])))
    assert result.diagnoses[0].verdict == "explained"
    assert names(result) == {"backlash"}


def relay(signal: np.ndarray, lower: float, upper: float) -> np.ndarray:
    """-1 or 1: at 1 from where the signal rises above `upper` to where it falls below `lower`."""
    out, at = np.empty(len(signal)), -1.0
    for i, value in enumerate(signal):
        at = 1.0 if value > upper else -1.0 if value < lower else at
        out[i] = at
    return out


@pytest.mark.parametrize("height", [1.2, -2.5])
@pytest.mark.parametrize("hidden", [{}, {"creep": {}}], ids=["alone", "beside creep"])
@pytest.mark.parametrize("seed", [2, 3])
@pytest.mark.long
def test_a_joint_that_snaps_has_no_name_but_a_place_and_a_size(seed, hidden, height):
    recording = recorded(hidden, seed=seed)
    snaps = 0.5 * height * relay(recording.values(SIMULATED), -12.0, 9.0)
    result = diagnosed(changed(recording, **{ANGLE: recording.values(ANGLE) + snaps}))
    (found,) = result.diagnoses
    assert names(result) == set(hidden)
    assert found.verdict == ("partly_explained" if hidden else "unknown_physics")
    assert found.unexplained.where == SnappingJoint.beyond
    assert 0.02 < found.unexplained.share <= 1.0
    assert found.unexplained.p_value < 1e-9
    assert found.after.heldout_rmse < 1.25 * NOISE < found.before.heldout_rmse
    way = "ahead" if height > 0 else "back"
    (said,) = (note for note in found.notes if f"The joint snaps {way} by" in note)
    assert said.startswith("The corrected simulation follows what the catalogue has no name for")


@pytest.mark.parametrize("height", [2.0, -3.0])
@pytest.mark.long
def test_of_a_joint_that_snaps_each_rest_has_a_curve_of_its_own(height):
    recording = recorded({}, seed=4)
    at = recording.values(SIMULATED)
    bent = height * np.cos(np.deg2rad(3.4 * at)) * (relay(at, -12.0, 9.0) > 0.0)
    result = diagnosed(changed(recording, **{ANGLE: recording.values(ANGLE) + bent}))
    (found,), (model,) = result.diagnoses, result.models
    assert (found.verdict, names(result)) == ("unknown_physics", set())
    assert found.unexplained.where == SnappingJoint.beyond
    assert found.after.heldout_rmse < 1.25 * NOISE
    (snap,) = (p for p in model.mechanism.pieces if isinstance(p.term, SnappingJoint))
    assert snap.term.form == CURVED


@pytest.mark.parametrize(("height", "piled"), [(-2.5, False), (3.5, False), (0.0, True)])
@pytest.mark.long
def test_where_repeats_say_much_against_the_first_choice_no_names_are_piled_up(
    monkeypatch, height, piled
):
    calls = []
    monkeypatch.setattr(explain, "polished", lambda *a: calls.append(1) or polished(*a))
    recording = recorded({"creep": {}}, seed=2)
    snaps = 0.5 * height * relay(recording.values(SIMULATED), -12.0, 9.0)
    found = explained(changed(recording, **{ANGLE: recording.values(ANGLE) + snaps}))
    assert any(isinstance(p.term, SnappingJoint) for p in found.choices[0].fit.pieces) != piled
    assert bool(calls) == piled


def test_samples_at_a_snap_say_when_it_was_and_not_that_they_are_mistaken():
    problem = posed(recorded({}))
    ground = ground_of(problem, NoiseModel(NOISE), problem.train)
    fit = evaluate(ground, [Piece(SnappingJoint(), np.array([3.0, -1.5, 21.0, 0.2]))])
    rows = leaping(problem, Choice(fit, (0, 0, 0), 0.0))
    moved = np.flatnonzero(np.diff(relay(fit.trace.body, -12.0, 9.0))) + 1
    assert len(moved) > 5
    assert np.all(rows[moved])
    assert np.mean(rows) < 0.1


def test_a_snap_is_the_relay_with_what_it_needs_to_go_over():
    signal = 30.0 * np.sin(np.arange(400) / 23.0)
    motion = Motion(signal, np.arange(400.0), np.zeros(400, dtype=int), {})
    values = np.array([3.0, -1.5, 21.0, 1e-3])
    joint = SnappingJoint()
    out, state = joint.respond(signal, motion, values, None)
    assert out - signal == pytest.approx(1.5 * relay(signal, -12.0, 9.0) + 1.5)
    parts = [joint.respond(signal[:150], motion, values, None)]
    parts.append(joint.respond(signal[150:], motion, values, parts[0][1]))
    assert np.concatenate([p[0] for p in parts]) == pytest.approx(out)
    assert parts[1][1] == pytest.approx(state)
    moved = np.flatnonzero(np.diff(relay(signal, -12.0, 9.0))) + 1
    assert set(moved) < set(np.flatnonzero(joint.leaps(motion, signal, values)))


@pytest.mark.parametrize("hidden", [{}, {"backlash": {"width": 4.0}}])
@pytest.mark.long
def test_a_joint_that_sticks_and_slips_is_not_noisy(hidden):
    recording = recorded(hidden, seed=3)
    command, rng = recording.values("pitch_command_deg"), np.random.default_rng(4)
    behind, at, give = np.zeros(len(command)), command[0], 6.0
    for k, there in enumerate(command):
        if abs(there - at) > give:
            at, give = there, rng.uniform(4.0, 9.0)
        behind[k] = there - at
    sticking = changed(recording, **{ANGLE: recording.values(ANGLE) - 0.25 * behind})
    (found,) = diagnosed(sticking).diagnoses
    assert found.verdict in ("unknown_physics", "partly_explained")
    assert found.unexplained.where == JERKS


def test_a_hum_of_the_size_of_the_noise_is_no_noise():
    recording = recorded({}, seed=5)
    hum = 0.8 * NOISE * np.sin(recording.values("time_s") / 9.0)
    (found,) = diagnosed(changed(recording, **{ANGLE: recording.values(ANGLE) + hum})).diagnoses
    assert found.verdict == "unknown_physics"
    assert "a hum in time" in found.unexplained.where


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_what_shakes_where_the_arm_is_stretched_out_is_no_mistaken_frame(seed):
    recording = recorded({}, seed=seed)
    out = np.clip(recording.values("pitch_command_deg") / 55.0, 0.0, 1.0) ** 2
    shaken = 15.0 * NOISE * out * np.sin(2.0 * np.pi * recording.values("time_s") / 21.0)
    (found,) = diagnosed(changed(recording, **{ANGLE: recording.values(ANGLE) + shaken})).diagnoses
    assert found.verdict == "unknown_physics"
    assert found.unexplained.where == SWINGS


@pytest.mark.parametrize("seed", [5, 6])
def test_a_hum_between_uneven_samples_is_none_of_their_noise(seed):
    rng = np.random.default_rng(seed)
    plain = recorded({}, seed=seed)
    time_s = np.cumsum(rng.choice([1.0, 3.0, 4.5, 7.0], len(plain.values("time_s"))))
    quiet = changed(plain, time_s=time_s)
    assert diagnosed(quiet).diagnoses[0].verdict == "no_mismatch"
    hum = 1.1 * NOISE * np.sin(2.0 * np.pi * time_s / 17.0)
    (found,) = diagnosed(changed(quiet, **{ANGLE: plain.values(ANGLE) + hum})).diagnoses
    assert found.verdict == "unknown_physics"
    assert period_of(found.unexplained.where) == pytest.approx(17.0, rel=0.02)


@pytest.mark.parametrize(("height", "middle"), [(1.2, 21.0), (-0.9, -30.0)])
@pytest.mark.long
def test_a_bump_at_one_place_is_told_and_no_pile_of_bends(height, middle):
    command = recorded({}).values("pitch_command_deg")
    bump = height / np.cosh((command - middle) / 3.0) ** 2
    result = diagnosed(moved(command + bump))
    (found,) = result.diagnoses
    assert (names(result), found.verdict) == ({"transmission_ripple"}, "partly_explained")
    assert found.unexplained.where == SingleBump.beyond
    there = next(p for p in found.physics[0].parameters if p.name == "middle")
    assert there.value == pytest.approx(middle, abs=0.5)
    assert found.after.heldout_rmse < 1.1 * NOISE < found.before.heldout_rmse


def stretching(dwells_s: tuple[float, float], foreseen: float) -> Recording:
    """A wire that goes on stretching for 40 s, by 0.15; dwells of every other cycle [s]."""
    plain = recorded({})
    command, odd = plain.values("pitch_command_deg"), plain.values("cycle") % 2 == 1
    time_s = np.cumsum(np.where(odd, *dwells_s))
    late = np.full(len(command), command[0])
    for k, left in enumerate(np.exp(-np.diff(time_s) / 40.0), start=1):
        late[k] = command[k] + (late[k - 1] - command[k]) * left
    return changed(moved(command + 0.15 * (foreseen * command - late)), time_s=time_s)


@pytest.mark.parametrize("foreseen", [0.0, 1.0])
def test_a_wire_that_goes_on_stretching_takes_back_what_has_arrived(foreseen):
    result = diagnosed(stretching((3.0, 9.0), foreseen))
    (found,) = result.diagnoses
    assert (names(result), found.verdict) == ({"creep"}, "explained")
    assert "goes on stretching" in found.physics[0].says
    time_constant = next(p for p in found.physics[0].parameters if p.name == "time_constant")
    assert time_constant.low < 40.0 < time_constant.high < 60.0
    assert found.after.heldout_rmse < 1.1 * NOISE < found.before.heldout_rmse


def test_a_wire_that_goes_on_stretching_is_told_at_one_dwell_as_well():
    result = diagnosed(stretching((3.0, 3.0), 1.0))
    (found,) = result.diagnoses
    assert (names(result), found.verdict) == ({"creep"}, "explained")
    assert found.after.heldout_rmse < 1.1 * NOISE < found.before.heldout_rmse


def test_a_wire_that_goes_on_stretching_is_told_where_a_sampled_command_rests():
    """Sampled every second: it runs for some samples, then rests for 4 to 70 s."""
    rng = np.random.default_rng(4)
    command = np.zeros(1)
    while len(command) < 1500:
        there, moving = rng.uniform(-20.0, 20.0), int(rng.integers(1, 4))
        ramp = np.linspace(command[-1], there, moving + 1)[1:]
        command = np.concatenate([command, ramp, np.full(rng.integers(4, 70), there)])
    time_s, late = np.arange(float(len(command))), np.zeros(len(command))
    for k in range(1, len(command)):
        late[k] = command[k] + (late[k - 1] - command[k]) * np.exp(-1.0 / 9.0)
    seen = 1.05 * command - 0.06 * late + rng.normal(0.0, 0.1, len(command))
    result = diagnosed(followed(time_s, command, seen, 0.0))
    assert (names(result), result.diagnoses[0].verdict) == ({"creep"}, "explained")
    assert result.diagnoses[0].after.heldout_rmse < 0.11


def test_nothing_left_does_not_hum():
    assert hum(np.zeros(50), np.arange(50.0)) == (False, 0.0, 0.0)


@pytest.mark.parametrize(
    ("error", "said"),
    [
        (lambda travel, pose: 6.0 * NOISE * (travel / 23.0 % 1.0 - 0.5), "command's way"),
        (lambda travel, pose: np.round(pose / 1.1) * 1.1 - pose, "in the angle"),
    ],
    ids=["a tooth of the travel", "steps of the angle"],
)
def test_what_comes_again_along_a_way_is_no_noise(error, said):
    recording = recorded({}, seed=5, cycles=9)
    smaller = 1.0 - 0.06 * recording.values("cycle")
    command = smaller * recording.values("pitch_command_deg")
    pose = CubicCurve(0.7, 1e-5)(command)
    wrong = error(np.cumsum(np.abs(np.diff(command, prepend=0.0))), pose)
    noise = NOISE * np.random.default_rng(5).standard_normal(len(pose))
    columns = {"pitch_command_deg": command, SIMULATED: pose, ANGLE: pose + wrong + noise}
    (found,) = diagnosed(changed(recording, **columns)).diagnoses
    assert (found.verdict, found.physics) == ("unknown_physics", ())
    assert said in found.unexplained.where


@pytest.mark.parametrize("seed", range(20))
def test_noise_does_not_hum_along_any_way(seed):
    rng = np.random.default_rng(seed)
    turns = 50.0 * np.sin(np.arange(1200) / 17.0)
    for along in (turns, np.cumsum(np.abs(np.diff(turns, prepend=0.0))), np.round(turns)):
        assert not hum(rng.standard_normal(1200), along)[0]


@pytest.mark.parametrize("rate", [0.006, -0.003])
@pytest.mark.long
def test_two_clocks_that_run_at_different_rates_are_one_name_and_more_than_that(rate):
    """Before, a loop that seems to grow was told as tension that is lost."""
    time_s = 0.02 * np.arange(700)
    there_s = (1.0 - rate) * time_s
    seen = 30.3 * np.sin(np.pi * there_s) + 0.3
    seen += 0.05 * np.random.default_rng(1).standard_normal(len(seen))
    drive = 30.0 * np.sin(np.pi * time_s)
    (found,) = diagnosed(followed(time_s, drive, seen, 0.5)).diagnoses
    assert found.verdict == "partly_explained"
    (physics,) = found.physics
    assert physics.name == "frame_lag"
    told = {p.name: p for p in physics.parameters}["rate"]
    assert told.low < rate < told.high
    assert told.value == pytest.approx(rate, rel=0.02)
    assert found.after.heldout_rmse < 0.05 * found.before.heldout_rmse
    if rate > 0.0:
        assert found.unexplained.where == RunningClock.beyond


def test_a_lag_that_stays_is_no_matter_of_two_clocks():
    time_s = 0.02 * np.arange(1500)
    seen = 30.3 * np.sin(np.pi * (time_s - 0.05)) + 0.3
    seen += 0.05 * np.random.default_rng(2).standard_normal(len(seen))
    recording = followed(time_s, 30.0 * np.sin(np.pi * time_s), seen, 0.5)
    (found,) = diagnosed(recording).diagnoses
    assert found.verdict in {"explained", "ambiguous"}
    (physics,) = found.physics
    assert "frame_lag" in {physics.name, *physics.alternatives}

"""A simulation that comes late or goes through play by itself: what is named acts inside of it."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from pipeline.discrepancy.model.model import CorrectedModel, as_json, from_json
from pipeline.discrepancy.model.result import DiagnosisResult, Evidence
from pipeline.discrepancy.problem.course import course_of
from pipeline.discrepancy.problem.course_trial import Course
from pipeline.discrepancy.problem.driven import driven_by
from pipeline.discrepancy.problem.static_misfit import loop_misfit, static_misfit
from pipeline.physics.mechanism import PLACES, OwnCourse
from pipeline.physics.motion import Motion
from pipeline.physics.play_operator import play
from pipeline.physics.second_order_lag import SecondOrderLag
from pipeline.physics.slip_spectrum import elements_of
from pipeline.recording import Recording
from tests.discrepancy.made import ANGLE, SIMULATED, changed, diagnosed, followed, names, value_of

PACE_HZ, STEP_S, NOISE, ROWS = 0.25, 0.02, 0.05, 2400
LATE_S, WIDTH = 0.12, 1.5


def commanded(time_s: np.ndarray) -> np.ndarray:
    turn = 2.0 * np.pi * PACE_HZ * time_s
    return np.asarray(20.0 * np.sin(turn) + 5.0 * np.sin(3.0 * turn + 0.4))


def curved(drive: np.ndarray) -> np.ndarray:
    return np.asarray(drive - 2e-4 * drive**3)


def late(values: np.ndarray, late_s: float = LATE_S) -> np.ndarray:
    """The bilinear filter of first order, at rest before."""
    k = 2.0 * late_s / STEP_S
    at_rest = [values[0] * (1.0 - 1.0 / (1.0 + k))]
    return np.asarray(lfilter([1 / (1 + k), 1 / (1 + k)], [1.0, (1 - k) / (1 + k)], values,
                              zi=at_rest)[0])  # fmt: skip


TIME_S = np.arange(ROWS) * STEP_S
DRIVE = commanded(TIME_S)


def course(simulated: np.ndarray) -> Course | None:
    return course_of({"other": np.cos(TIME_S), "motor": DRIVE}, TIME_S, simulated)


def test_a_curve_that_comes_late_is_found_with_how_late():
    found = course(late(curved(DRIVE)))
    assert found is not None
    assert found.command == "motor"
    assert kinds(found) == {"curve": ["response_lag/running"]}
    assert found.own.curve[0].values[0] == pytest.approx(LATE_S, rel=0.02)
    np.testing.assert_allclose(found.reproduced[100:], late(curved(DRIVE))[100:], atol=0.05)
    np.testing.assert_allclose(found.curve(DRIVE), curved(DRIVE), atol=0.05)


def kinds(found: Course) -> dict[str, list[str]]:
    """What a course has, by its places."""
    own = {place: getattr(found.own, place) for place in PLACES}
    return {at: [f"{p.term.name}/{p.term.form}" for p in some] for at, some in own.items() if some}


def crept(values: np.ndarray) -> np.ndarray:
    """A fifth of each motion comes 0.8 s late."""
    return np.asarray(0.8 * values + 0.2 * late(values, 0.8))


def test_a_curve_that_creeps_is_found_with_how_much_and_how_slowly():
    found = course(crept(curved(DRIVE)))
    assert found is not None
    assert kinds(found) == {"curve": ["creep/running"]}
    np.testing.assert_allclose(found.own.curve[0].values, [0.2, 0.8], rtol=0.02)


def test_what_is_missing_before_the_simulations_creep_is_put_there():
    rippling = DRIVE + 1.2 * np.sin(2.0 * np.pi * DRIVE / 9.0)
    found = diagnosed(real(crept(curved(DRIVE)), crept(curved(rippling))))
    assert names(found) == {"transmission_ripple"}
    assert found.diagnoses[0].after.heldout_rmse < 1.1 * NOISE


def rubbed(drive: np.ndarray) -> np.ndarray:
    """A wire in a sheath: sliders that give way over up to 8 deg hold it back by 1.8 deg."""
    most = np.full(12, 0.15)
    held, stiff, out = np.zeros(12), most / np.linspace(1.0, 8.0, 12), np.empty(len(drive))
    for i, step in enumerate(np.diff(drive, prepend=drive[0])):
        held = np.clip(held + stiff * step, -most, most)
        out[i] = drive[i] - held.sum()
    return out


def test_a_curve_of_a_drive_that_rubs_by_a_law_of_its_own_is_found_with_its_sliders():
    found = course(curved(rubbed(DRIVE)))
    assert found is not None
    assert kinds(found) == {"drive": ["friction/driven spectrum"]}
    assert np.std(found.reproduced - curved(rubbed(DRIVE))) < 2e-4 * np.ptp(DRIVE)


def held_at_joint(
    asked: np.ndarray, load: Callable[[float], float] = lambda angle: 0.0
) -> np.ndarray:
    """A joint at which four sliders and a load balance what a wire asks for, by bisection."""
    most, stiff = np.array([0.2, 0.3, 0.3, 0.2]), np.array([0.4, 0.2, 0.08, 0.04])
    stuck, out = np.full(4, asked[0]), np.empty(len(asked))
    for i, wanted in enumerate(asked):
        low, high = -60.0, 60.0
        while high - low > 1e-10:
            angle = 0.5 * (low + high)
            force = np.clip(stiff * (angle - stuck), -most, most).sum()
            low, high = (low, angle) if angle + force + load(angle) > wanted else (angle, high)
        out[i] = angle
        held = np.clip(stiff * (angle - stuck), -most, most)
        stuck = angle - held / stiff
    return out


HELD = held_at_joint(curved(DRIVE))


def test_a_loop_is_no_static_curve_though_all_neighbours_are_of_its_other_cycles():
    nearly = DRIVE * (1.0 + 1e-12 * np.arange(ROWS))
    assert static_misfit(nearly, HELD) > 5e-3
    assert static_misfit(nearly, curved(DRIVE)) < 1e-4


def test_one_loop_gone_through_again_and_again_is_told_from_several():
    sine = 20.0 * np.sin(2.0 * np.pi * PACE_HZ * TIME_S)
    assert loop_misfit(sine[200:], late(sine)[200:]) < 1e-3
    assert loop_misfit(DRIVE[200:], late(DRIVE)[200:]) > 1e-2


def test_a_joint_that_rubs_in_the_simulation_is_found_with_its_sliders():
    found = course(HELD)
    assert found is not None
    places = {place: c for c in (found, found.otherwise) if c is not None for place in kinds(c)}
    assert set(places) == {"drive", "joint"}
    at_joint = places["joint"]
    assert np.std(at_joint.reproduced - HELD) < 4e-4 * np.ptp(HELD)
    assert elements_of(at_joint.own.joint[0].values)[1].sum() == pytest.approx(1.0, rel=0.05)


def test_what_is_missing_beside_the_simulations_friction_at_the_joint_meets_it_there():
    recording = real(HELD, held_at_joint(curved(DRIVE), lambda a: 0.3 * max(a - 9.0, 0.0)))
    found = diagnosed(recording)
    assert names(found) == {"contact"}
    assert found.diagnoses[0].verdict == "explained"
    assert found.diagnoses[0].after.heldout_rmse < 1.1 * NOISE
    (model,), (evidence,) = found.models, found.evidence
    stored = from_json(as_json(model), ["yaw_command_deg"])
    assert stored.mechanism.course is not None
    assert [piece.term.form for piece in stored.mechanism.course.joint] == ["spectrum"]
    np.testing.assert_array_equal(stored.predict(evidence.motion)[0], evidence.after)
    begun, state = stored.mechanism.respond(evidence.motion.rows(np.arange(900)))
    on, _ = stored.mechanism.respond(evidence.motion.rows(np.arange(900, ROWS)), state)
    whole = stored.mechanism.respond(evidence.motion)[0]
    np.testing.assert_allclose(np.concatenate([begun, on]), whole, atol=1e-6)


def test_what_is_missing_before_the_simulations_friction_is_put_there():
    rippling = DRIVE + 1.2 * np.sin(2.0 * np.pi * DRIVE / 9.0)
    found = diagnosed(real(curved(rubbed(DRIVE)), curved(rubbed(rippling))))
    assert names(found) == {"transmission_ripple"}
    assert found.diagnoses[0].after.heldout_rmse < 1.15 * NOISE


def test_a_curve_behind_play_is_found_with_how_wide():
    found = course(curved(play(DRIVE, 0.5 * WIDTH, DRIVE[0])))
    assert found is not None
    assert kinds(found) == {"drive": ["backlash/"]}
    assert found.own.drive[0].values[0] == pytest.approx(WIDTH, rel=0.01)


def played(drive: np.ndarray) -> np.ndarray:
    return play(drive, 0.5 * WIDTH, drive[0])


LAG, RUBS = "response_lag/running", "friction/spectrum"


@pytest.mark.parametrize(
    ("simulated", "own"),
    [
        (late(curved(played(DRIVE))), {"drive": ["backlash/"], "curve": [LAG]}),
        (curved(played(late(DRIVE))), {"drive": [LAG, "backlash/"]}),
        (held_at_joint(late(curved(DRIVE))), {"curve": [LAG], "joint": [RUBS]}),
        (late(HELD), {"joint": [RUBS], "sensor": [LAG]}),
        (late(curved(rubbed(DRIVE))), {"drive": ["friction/driven spectrum"], "curve": [LAG]}),
        (curved(rubbed(late(DRIVE))), {"drive": [LAG, "friction/driven spectrum"]}),
    ],
    ids=["play, late", "late, play", "late, joint rubs", "joint rubs, late", "rubs, late",
         "late, rubs"],
)  # fmt: skip
@pytest.mark.long
def test_a_curve_that_comes_late_and_is_held_back_is_found_with_both_in_their_order(simulated, own):
    best = course(simulated)
    assert best is not None
    (found,) = [c for c in (best, best.otherwise) if c is not None and kinds(c) == own]
    lag = next(piece for piece in found.own.pieces if piece.term.name == "response_lag")
    assert lag.values[0] == pytest.approx(LATE_S, rel=0.02)
    assert np.std(found.reproduced - simulated) < 2e-4 * np.ptp(simulated)


def test_a_lag_of_second_order_beside_play_is_found_with_its_damping():
    swing = SecondOrderLag()
    motion = Motion(DRIVE, TIME_S, np.zeros(ROWS, dtype=np.int64), {})
    asked = curved(played(DRIVE))
    found = course(swing.respond(asked, motion, np.array([12.0, 0.5, 1.0]), None)[0])
    assert found is not None
    assert kinds(found) == {"drive": ["backlash/"], "curve": ["response_lag/second"]}
    np.testing.assert_allclose(found.own.curve[0].values[:2], [12.0, 0.5], rtol=0.02)
    assert found.own.drive[0].values[0] == pytest.approx(WIDTH, rel=0.02)


@pytest.mark.parametrize(
    "simulated",
    [
        curved(DRIVE),
        DRIVE + 3.0 * np.cos(TIME_S),
        late(DRIVE) + 0.3 * np.random.default_rng(0).standard_normal(ROWS),
        np.full(ROWS, np.nan),
        np.ones(ROWS),
    ],
    ids=["static", "two commands", "noisy", "empty", "still"],
)
@pytest.mark.long
def test_there_is_none_of_another(simulated):
    assert course(simulated) is None


def test_a_mix_of_two_commands_of_a_circle_is_no_lag_of_one_though_it_looks_like_it_later():
    time_s = 0.2 * np.arange(250)
    turn = 2.0 * np.pi * time_s / 12.5
    motors = {"one": 350.0 * np.cos(turn), "other": 350.0 * np.sin(turn)}
    mixed = 0.016 * motors["one"] + 0.018 * motors["other"] + 6.0 * np.exp(-time_s / 0.4)
    assert course_of(motors, time_s, mixed) is None


@pytest.mark.long
def test_where_two_commands_mix_and_come_late_no_one_of_them_is_held_to_rub_and_swing():
    time_s = 0.2 * np.arange(330)
    turn = 2.0 * np.pi * time_s / 12.5
    size = 300.0 + 8.0 * np.sin(0.11 * time_s)
    motors = {"one": size * np.cos(turn), "other": size * np.sin(turn)}
    asked = 0.016 * motors["one"] + 0.014 * motors["other"]
    mixed = np.asarray(lfilter([0.3], [1.0, -0.7], asked))
    assert course_of(motors, time_s, mixed) is None


def real(simulated: np.ndarray, clean: np.ndarray) -> Recording:
    seen = 1.01 * clean + 0.3 + NOISE * np.random.default_rng(2).standard_normal(len(clean))
    recording = followed(TIME_S, DRIVE, seen, PACE_HZ)
    return changed(recording, **{SIMULATED: simulated})


def stored_again(found: DiagnosisResult) -> tuple[CorrectedModel, Evidence]:
    """The model as it comes back from its file, which answers as it did, and the evidence."""
    (model,), (evidence,) = found.models, found.evidence
    stored = from_json(as_json(model), ["yaw_command_deg"])
    np.testing.assert_array_equal(stored.predict(evidence.motion)[0], evidence.after)
    return stored, evidence


@pytest.fixture(scope="module")
def geared():
    """Play before a joint that is late, which the simulation knows; it knows of no play."""
    behind = late(curved(play(DRIVE, 0.5 * WIDTH, DRIVE[0])))
    recording = real(late(curved(DRIVE)), behind)
    return recording, diagnosed(recording)


def test_what_is_missing_before_the_simulations_lag_is_put_there(geared):
    _, found = geared
    assert names(found) == {"backlash"}
    assert value_of(found, "backlash", "width").value == pytest.approx(WIDTH, rel=0.05)
    assert found.diagnoses[0].after.heldout_rmse < 1.1 * NOISE
    assert any("The simulation itself has" in note for note in found.diagnoses[0].notes)


def test_its_stored_model_answers_with_the_simulations_lag(geared):
    recording, found = geared
    stored, evidence = stored_again(found)
    error = recording.values(ANGLE) - evidence.after
    without = replace(stored, mechanism=replace(stored.mechanism, course=None), later=None)
    assert np.std(error) < 1.1 * NOISE
    assert np.std(recording.values(ANGLE) - without.predict(evidence.motion)[0]) > 5.0 * NOISE


@pytest.fixture(scope="module")
def stopped():
    """A joint that stops at 12 deg, seen through a filter that is late; the simulation knows it."""
    recording = real(late(curved(DRIVE)), late(np.minimum(curved(DRIVE), 12.0)))
    return recording, diagnosed(recording)


@pytest.mark.long
def test_a_lag_of_the_sensor_comes_behind_what_is_missing_at_the_joint(stopped):
    _, found = stopped
    assert names(found) <= {"end_stop", "contact"}
    assert found.diagnoses[0].verdict in ("explained", "ambiguous")
    assert found.diagnoses[0].after.heldout_rmse < 1.1 * NOISE
    assert any("acts before it, at the joint too" in note for note in found.diagnoses[0].notes)


def test_its_stored_model_has_the_lag_last(stopped):
    _, found = stopped
    stored, evidence = stored_again(found)
    assert stored.mechanism.course is not None
    assert [piece.term.name for piece in stored.mechanism.course.sensor] == ["response_lag"]
    lag = stored.mechanism.course.sensor
    first = replace(stored.mechanism, course=OwnCourse(curve=lag))
    other = first.respond(evidence.motion)[0] - stored.mechanism.respond(evidence.motion)[0]
    assert np.max(np.abs(other)) > 5.0 * NOISE


def test_a_lag_that_the_simulation_has_is_no_mismatch():
    found = diagnosed(real(late(curved(DRIVE)), late(curved(DRIVE))))
    assert found.diagnoses[0].verdict == "no_mismatch"


def test_of_commands_that_are_alike_the_axis_has_its_own():
    recording = real(late(curved(DRIVE)), late(curved(DRIVE)))
    both = changed(recording, yaw_command_deg=DRIVE)
    other_first = replace(both, channels=(both.channels[1], both.channels[0], *both.channels[2:]))
    driven = driven_by(other_first, ANGLE, other_first.values(SIMULATED))
    assert driven.course is not None
    assert driven.drive == "pitch_command_deg"


RIPPLING = DRIVE + 1.2 * np.sin(2.0 * np.pi * DRIVE / 9.0)


@pytest.mark.parametrize(
    "own",
    [
        lambda u: curved(played(late(u))),
        pytest.param(lambda u: late(held_at_joint(curved(u))), marks=pytest.mark.long),
        pytest.param(lambda u: late(curved(rubbed(u))), marks=pytest.mark.long),
    ],
    ids=["late, play", "joint rubs, late", "rubs, late"],
)  # fmt: skip
def test_what_is_missing_before_both_is_put_there(own):
    found = diagnosed(real(own(DRIVE), own(RIPPLING)))
    assert names(found) == {"transmission_ripple"}
    assert found.diagnoses[0].verdict == "explained"
    assert found.diagnoses[0].after.heldout_rmse < 1.1 * NOISE


@pytest.mark.long
def test_a_stop_before_a_filter_and_behind_play_that_the_simulation_has_is_put_there():
    played_late = curved(played(DRIVE))
    found = diagnosed(real(late(played_late), late(np.minimum(played_late, 12.0))))
    assert names(found) <= {"end_stop", "contact"}
    (model,) = found.models
    stored = from_json(as_json(model), ["yaw_command_deg"])
    assert stored.mechanism.course is not None
    assert [p.term.name for p in stored.mechanism.course.sensor] == ["response_lag"]
    assert [p.term.name for p in stored.mechanism.course.drive] == ["backlash"]
    assert found.diagnoses[0].after.heldout_rmse < 1.1 * NOISE


@pytest.fixture(scope="module")
def drummed():
    """A drum that runs out of true behind play; the simulation knows of the play alone."""

    def turned(drive: np.ndarray, amplitude: float) -> np.ndarray:
        behind = play(drive, 0.5 * WIDTH, drive[0])
        return curved(behind + amplitude * np.sin(2.0 * np.pi * behind / 9.0 + 0.5))

    recording = real(turned(DRIVE, 0.0), turned(DRIVE, 0.8))
    return recording, diagnosed(recording)


def test_what_is_missing_behind_the_simulations_play_is_put_there(drummed):
    _, found = drummed
    assert names(found) == {"transmission_ripple"}
    assert value_of(found, "transmission_ripple", "amplitude").value == pytest.approx(0.8, rel=0.03)
    assert found.diagnoses[0].verdict == "explained"
    assert found.diagnoses[0].after.heldout_rmse < 1.05 * NOISE
    assert any("acts behind it, at the drive too" in note for note in found.diagnoses[0].notes)


def test_its_stored_model_has_the_play_first(drummed):
    _, found = drummed
    stored, evidence = stored_again(found)
    course = stored.mechanism.course
    assert course is not None
    assert [piece.term.name for piece in course.shaft] == ["backlash"]
    last = replace(stored.mechanism, course=OwnCourse(drive=course.shaft))
    other = last.respond(evidence.motion)[0] - stored.mechanism.respond(evidence.motion)[0]
    assert np.std(other) > 2.0 * NOISE

"""Diagnoses where no cycle repeats another, so that nothing but time tells noise from physics."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from pipeline.config import DiagnosisConfig
from pipeline.discrepancy.fitting.fit import evaluate
from pipeline.discrepancy.judgement import decision
from pipeline.discrepancy.judgement.structure import Structure
from pipeline.discrepancy.noise.family import noise_family
from pipeline.discrepancy.noise.learning import NoisePrior
from pipeline.discrepancy.noise.noise import NoiseModel
from pipeline.discrepancy.problem.posing import pose_problem
from pipeline.discrepancy.problem.problem import Problem
from pipeline.discrepancy.search.explain import explain
from pipeline.discrepancy.search.foretold import (
    errors_ahead,
    foretold_part,
    least_errors,
    parts_of,
)
from pipeline.discrepancy.search.weighing import wanders
from pipeline.physics.catalogue import term
from pipeline.physics.kinematics import CubicCurve
from pipeline.physics.mechanism import Mechanism
from pipeline.physics.motion import Motion
from pipeline.physics.piece import Piece
from pipeline.recording import Channel, Recording, with_context
from pipeline.stages.diagnosis import diagnose

NOISE = 0.2
ROWS, DWELL_S = 900, 0.5
CHANNELS = (
    Channel("motor_deg", "command", "deg"),
    Channel("tip_deg", "measurement", "deg"),
    Channel("tip_sim_deg", "simulation", "deg", of="tip_deg"),
)
TIME_S = np.arange(ROWS) * DWELL_S
WAVES = sum(np.sin(2.0 * np.pi * f * TIME_S / TIME_S[-1] + f) for f in (5.0, 12.3, 19.1))
ONCE = 40.0 * np.sin(2.0 * np.pi * np.arange(ROWS) / ROWS)


def moved(
    command_deg: np.ndarray,
    *hidden: tuple[str, list[float]],
    seed: int,
    time_s: np.ndarray = TIME_S,
) -> Recording:
    """A mechanism with hidden terms ("name/form", parameters), measured with white noise."""
    motion = Motion(command_deg, time_s, np.zeros(ROWS, dtype=int))
    pieces = [Piece(term(*key.split("/")), np.array(values)) for key, values in hidden]
    curve = CubicCurve(0.7, 1e-5)
    noise = NOISE * np.random.default_rng(seed).standard_normal(ROWS)
    measured = Mechanism(curve, pieces, 1.02, 0.4).respond(motion)[0] + noise
    columns = [time_s, command_deg, measured, curve(command_deg)]
    names = ["time_s", *(channel.name for channel in CHANNELS)]
    samples = pd.DataFrame(dict(zip(names, columns, strict=True)))
    return Recording(with_context(samples, CHANNELS), CHANNELS, "simulated")


def problem_of(recording: Recording) -> Problem:
    sim = recording.values("tip_sim_deg")
    return pose_problem(DiagnosisConfig(), recording, "tip_deg", sim)


def named(recording: Recording) -> set[str]:
    return {p.name for p in diagnose(DiagnosisConfig(), recording).diagnoses[0].physics}


def test_a_slip_is_named_however_late_it_is():
    hidden = ("backlash", [3.0]), ("lost_steps", [1.5, 260.0])
    assert named(moved(20.0 * WAVES, *hidden, seed=1)) == {"backlash", "lost_steps"}


def test_a_lag_that_swings_is_found_where_a_plain_delay_comes_near_it():
    assert named(moved(20.0 * WAVES, ("response_lag/second", [0.9, 0.5, 0.6]), seed=2)) == {
        "response_lag"
    }


@pytest.mark.parametrize("seed", [9, 10])
@pytest.mark.long
def test_a_zero_that_jitters_a_little_is_neither_slip_nor_drift(seed):
    cycle = np.arange(ROWS) // 100
    growing = (30.0 + 1.5 * cycle) * np.sin(2.0 * np.pi * np.arange(ROWS) / 100)
    recording = moved(growing, ("backlash", [3.0]), seed=seed)
    zero = 0.4 * NOISE * np.random.default_rng(seed).standard_normal(9)
    tip = recording.values("tip_deg") + zero[cycle]
    jittering = Recording(recording.samples.assign(tip_deg=tip), CHANNELS, "simulated")
    assert named(jittering) == {"backlash"}


def test_a_zero_that_wanders_far_is_drift_and_no_noise():
    recording = moved(20.0 * WAVES, ("backlash", [3.0]), seed=3)
    tip = recording.values("tip_deg") + 1.5 * np.sin(5.0 * TIME_S / TIME_S[-1])
    wandering = Recording(recording.samples.assign(tip_deg=tip), CHANNELS, "simulated")
    assert "drift" in named(wandering)


def test_a_hum_is_no_noise():
    recording = moved(20.0 * WAVES, seed=6)
    tip = recording.values("tip_deg") + 1.2 * np.sin(TIME_S)
    humming = Recording(recording.samples.assign(tip_deg=tip), CHANNELS, "simulated")
    (found,) = diagnose(DiagnosisConfig(), humming).diagnoses
    assert found.verdict == "unknown_physics"
    assert "every 6.2" in found.unexplained.where


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_what_a_stroke_from_an_end_remembers_is_no_physics(side):
    """Three short cycles that begin at an end, with the play on either side before."""
    turn = np.concatenate([np.arange(30), np.arange(30, 0, -1)]) - 15.0
    command = np.tile(3.0 * turn, 3)
    before = np.concatenate([[command[0] + side * 20.0], command])
    time_s = np.arange(len(before)) * 0.5
    motion = Motion(before, time_s, np.zeros(len(before), dtype=int))
    clean = Mechanism(CubicCurve(0.8, 0.0), [Piece(term("backlash"), np.array([5.0]))]).respond(
        motion
    )[0][1:]
    noise = NOISE * np.random.default_rng(7).standard_normal(len(command))
    columns = [time_s[1:], command, clean + noise, 0.8 * command]
    samples = pd.DataFrame(dict(zip(["time_s", *(c.name for c in CHANNELS)], columns, strict=True)))
    recording = Recording(with_context(samples, CHANNELS), CHANNELS, "simulated")
    assert named(recording) == {"backlash"}


def test_in_one_cycle_a_bend_takes_no_second_name():
    assert len(named(moved(ONCE, ("lens_distortion", [1e-4, 0.0]), seed=4))) == 1


def test_only_commands_that_were_fitted_are_foretold():
    recording = moved(ONCE, seed=5)
    ground = explain(problem_of(recording)).choices[0].fit.ground
    for part in parts_of(ground):
        assert ONCE[part.ahead].min(initial=0.0) >= ONCE[part.early].min()
        assert not part.early[part.ahead].any()
    assert len(parts_of(ground)[0].ahead) < 0.25 * ground.count


def test_what_is_foretold_settles_no_more_names():
    found = explain(problem_of(moved(20.0 * WAVES, ("backlash", [3.0]), seed=6)))
    best = found.choices[0]
    drift = Piece(term("drift", "linear"), np.array([0.2]))
    more = replace(best, fit=evaluate(best.fit.ground, (*best.fit.pieces, drift)))
    other = replace(best, fit=evaluate(best.fit.ground, (drift,)))
    errors = np.array([0.21, 0.20, 0.22])
    np.testing.assert_allclose(least_errors([best, more, other], errors), [0.21, 0.20, 0.21])
    walking = replace(best, place=(0, 0, 1))
    np.testing.assert_allclose(least_errors([walking, more, other], errors), [0.20, 0.20, 0.21])


def test_errors_that_share_a_zero_say_less_of_what_is_foretold():
    recording = moved(20.0 * WAVES, seed=6)
    best = explain(problem_of(recording)).choices[0]
    ground, parts = best.fit.ground, parts_of(best.fit.ground)
    still = replace(ground.noise, jitter=0.0)
    jittery = replace(ground.noise, jitter=0.3 * ground.noise.deviation)
    counts = [
        errors_ahead(replace(best, fit=replace(best.fit, ground=ground.with_noise(n))), parts)
        for n in (still, jittery)
    ]
    assert 3.0 * counts[1] < counts[0]


def test_a_frame_behind_is_told_from_play_where_samples_come_unevenly():
    time_s = np.cumsum(np.random.default_rng(7).choice([0.25, 0.5, 1.0, 1.5], ROWS))
    command = 40.0 * (2.0 / np.pi) * np.arcsin(np.sin(2.0 * np.pi * np.arange(ROWS) / 75.0))
    hidden = ("frame_lag/frames", [1.0]), ("lost_steps", [1.5, float(time_s[600])])
    assert named(moved(command, *hidden, seed=8, time_s=time_s)) == {"frame_lag", "lost_steps"}


def test_steady_noise_leaves_a_wandering_zero_to_the_terms():
    walk = np.cumsum(np.random.default_rng(9).standard_normal(ROWS))
    prior = NoisePrior(NoiseModel(1.0), 0, 1.0, ())
    recording = moved(ONCE, seed=9)
    problem = problem_of(recording)
    family = noise_family(prior, problem, np.ones(ROWS, dtype=bool))
    assert wanders(family.pick(walk, (0, 0, 0))[1])
    assert not wanders(replace(family, steady=True).pick(walk, (0, 0, 0))[1])


def test_slips_are_told_in_place_of_a_zero_that_walks_where_no_cycle_repeats_another():
    slips = [3.0, 60.0, -4.0, 200.0, 3.0, 270.0]
    recording = moved(20.0 * WAVES, ("lost_steps/thrice", slips), seed=3)
    found = explain(problem_of(recording))
    assert found.prior.repeats == 0
    assert [(p.term.name, p.term.form) for p in found.choices[0].fit.pieces] == [
        ("lost_steps", "thrice")
    ]
    assert not wanders(found.choices[0].place)


@pytest.mark.parametrize(("share", "told"), [(1e-4, False), (0.1, True)])
@pytest.mark.parametrize("shows", ["structure_of", "disproved"])
def test_a_rest_that_is_small_is_the_form_of_what_was_named(monkeypatch, shows, share, told):
    found = explain(problem_of(moved(20.0 * WAVES, ("backlash", [6.0]), seed=1)))
    assert found.prior.repeats == 0
    rest = Structure(True, "elsewhere", share, 1e-9, wandering=NoiseModel(NOISE))
    monkeypatch.setattr(decision, shows, lambda *_: rest)
    decided = decision.decided(found.problem, found)
    assert decided.structure.found == told
    assert decided.choice.fit.names == ("backlash",)


def test_of_a_pile_of_names_beside_a_rest_at_most_the_one_that_is_most_of_it_stays(monkeypatch):
    """As many names as a search takes follow the shape of anything, in later rows, too."""
    found = explain(problem_of(moved(20.0 * WAVES, ("backlash", [6.0]), seed=1)))
    best = next(c for c in found.choices if c.fit.names == ("backlash",))
    others = {
        "gravity": [2.0, 0.3],
        "transmission_ripple": [0.6, 9.0, 0.2],
        "camera_tilt": [8.0, 0.1],
    }
    pieces = [*best.fit.pieces, *(Piece(term(n), np.array(v)) for n, v in others.items())]
    pile = replace(best, fit=evaluate(best.fit.ground, pieces))
    monkeypatch.setattr(decision, "foretold_part", lambda *_: pile)
    rest = Structure(True, "elsewhere", 0.1, 1e-9)
    kept, structure = decision.without_repeats(found.problem, found, pile, rest, True)
    assert kept.fit.names == ("backlash",)
    assert structure == rest


def test_held_out_rows_refute_however_small_a_rest_is(monkeypatch):
    found = explain(problem_of(moved(20.0 * WAVES, ("backlash", [6.0]), seed=1)))
    refuted = Structure(True, "on held-out samples", 1e-4, 1e-9)
    monkeypatch.setattr(decision, "disproved", lambda *_: refuted)
    assert decision.decided(found.problem, found).structure.found


@pytest.mark.parametrize("rest", [0.01, 1.0])
def test_a_slip_far_larger_than_the_rest_stays_and_so_does_what_is_foretold_beside_it(rest):
    """rest: the mean square of what is left [deg^2]; the slip explains some 2."""
    hidden = ("backlash", [3.0]), ("lost_steps", [4.0, 330.0])
    recording = moved(20.0 * WAVES, *hidden, seed=1)
    found = explain(problem_of(recording))
    best = next(c for c in found.choices if set(c.fit.names) == {"backlash", "lost_steps"})
    kept = foretold_part(found.choices, best, rest)
    assert set(kept.fit.names) == ({"backlash", "lost_steps"} if rest < 0.1 else set())
    alone = next(c for c in found.choices if c.fit.names == ("lost_steps",))
    assert foretold_part(found.choices, alone, rest).fit.names == alone.fit.names[: rest < 0.1]


@pytest.mark.long
def test_a_zero_that_walks_at_random_by_twice_the_noise_is_seldom_drift_or_slip():
    verdicts = []
    for seed in range(1, 25):
        recording = moved(20.0 * WAVES, seed=seed)
        walk = np.cumsum(np.random.default_rng(seed).standard_normal(ROWS))
        tip = recording.values("tip_deg") + 2.0 * NOISE / np.std(walk) * walk
        walking = Recording(recording.samples.assign(tip_deg=tip), CHANNELS, "simulated")
        verdicts.append(diagnose(DiagnosisConfig(), walking).diagnoses[0].verdict)
    assert verdicts.count("no_mismatch") >= 20


@pytest.mark.parametrize(("seed", "size"), [(1, 0.7), (2, 1.0)])
def test_a_drift_is_told_in_place_of_a_walk_where_no_cycle_repeats_another(seed, size):
    time = TIME_S / TIME_S[-1]
    course = time if seed % 2 else 1.0 - np.exp(-time / 0.4)
    recording = moved(20.0 * WAVES, seed=seed)
    tip = recording.values("tip_deg") + size * NOISE / np.std(course) * course
    drifting = Recording(recording.samples.assign(tip_deg=tip), CHANNELS, "simulated")
    assert named(drifting) == {"drift"}

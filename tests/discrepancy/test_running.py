"""Motion that runs on between samples, wires that creep before a bent curve, loops that grow."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from pipeline.discrepancy.fitting.fit import evaluate, improve
from pipeline.discrepancy.search.ties import standing
from pipeline.physics.catalogue import BENDS, term
from pipeline.physics.kinematics import CubicCurve
from pipeline.physics.mechanism import Mechanism
from pipeline.physics.motion import Motion
from pipeline.physics.piece import Piece
from pipeline.recording import Recording
from tests.discrepancy.made import ANGLE, CHANNELS, SIMULATED, diagnosed, explained, recorded

CURVE = CubicCurve(0.7, 6e-5)
SIZES, DWELLS = (50.0, 30.0, 42.0, 24.0), (0.2, 0.6, 0.2, 0.4)


def driven(cycles: int = 8, steps: int = 100) -> Motion:
    """Cycles of four amplitudes and three dwells [s], by turns."""
    shape = np.interp(np.arange(steps) / steps, [0.0, 0.25, 0.75, 1.0], [0.0, 1.0, -1.0, 0.0])
    drive = np.concatenate([SIZES[k % 4] * shape for k in range(cycles)])
    dwell = np.repeat([DWELLS[k % 4] for k in range(cycles)], steps)
    cycle = np.repeat(np.arange(cycles), steps)
    return Motion(drive, np.cumsum(dwell), cycle, {"yaw_command_deg": np.zeros(len(drive))})


def measured(key: str, values: list[float], noise: float = 0.1, seed: int = 5) -> Recording:
    name, _, form = key.partition("/")
    motion = driven()
    clean = Mechanism(CURVE, [Piece(term(name, form), np.array(values))], 1.02, 0.4)
    angle = clean.respond(motion)[0]
    samples = pd.DataFrame(
        {
            "time_s": motion.time_s,
            "cycle": motion.cycle,
            "step": np.arange(len(motion)) % 100,
            "pitch_command_deg": motion.drive,
            "yaw_command_deg": motion.others["yaw_command_deg"],
            ANGLE: angle + noise * np.random.default_rng(seed).standard_normal(len(motion)),
            SIMULATED: CURVE(motion.drive),
        }
    )
    return Recording(samples, CHANNELS, "simulated")


@pytest.mark.parametrize(
    ("key", "values"),
    [
        ("response_lag/running", [0.15]),
        ("creep/running", [0.2, 0.75]),
        ("creep/wire", [0.25, 2.0, 1.0, 0.0]),
        ("creep/wire", [0.25, 20.0, 1.0, 30.0]),
        ("friction/driven asymmetric", [5.0, 12.0, 1.0, 0.35]),
        ("compliance/driven", [0.3, 12.0, 2.0, 0.0]),
        ("contact/upper lossy", [0.4, 12.0, 0.3, 2.5, 0.2]),
        ("tension_loss/cycle", [0.5, 0.6]),
        ("tension_loss/round", [0.0025, 0.8, 0.9]),
    ],
)
@pytest.mark.long
def test_one_name_holds_what_other_forms_of_it_need_others_for(key, values):
    best = explained(measured(key, values)).choices[0]
    assert best.fit.names == (key.partition("/")[0],)
    np.testing.assert_allclose(best.fit.pieces[0].values[:2], values[:2], rtol=0.15, atol=0.1)


def test_a_lag_far_shorter_than_a_dwell_is_a_delay_of_what_runs_on():
    motion = driven()
    lag, late = 0.01, term("response_lag", "running")
    answer, _ = late.respond(motion.drive, motion, np.array([lag]), None)
    delayed = np.interp(motion.time_s - lag, motion.time_s, motion.drive)
    np.testing.assert_allclose(answer, delayed, atol=1e-9)


def test_creep_of_a_wire_that_was_moved_before_forgets_it_with_its_own_time():
    motion, creep = driven(), term("creep", "wire")
    rested, _ = creep.respond(motion.drive, motion, np.array([0.2, 5.0, 1.0, 0.0]), None)
    moved, _ = creep.respond(motion.drive, motion, np.array([0.2, 5.0, 1.0, 10.0]), None)
    since = motion.time_s - motion.time_s[0]
    np.testing.assert_allclose(moved - rested, 2.0 * np.exp(-since / 5.0), atol=1e-12)


def test_where_one_bend_could_stand_for_a_contact_each_could():
    found = explained(recorded({"lens_distortion": {"distortion": 6e-5, "centre": 12.0}}))
    lens = next(c for c in found.choices if c.fit.names == ("lens_distortion",))
    fit = lens.fit.ground
    contact = improve(evaluate(fit, [Piece(term("contact", "upper"), np.array([0.5, 10.0, 2.0]))]))
    near = replace(lens, fit=contact, score=lens.score - 1.0)
    alternatives = standing("contact", near, [near, lens], found.problem).alternatives
    assert set(alternatives) >= BENDS


def test_an_old_frame_is_no_lag_of_a_command_that_may_have_run_on():
    best = explained(measured("frame_lag/time", [0.025])).choices[0]
    assert best.fit.names == ("frame_lag",)


@pytest.mark.parametrize(
    ("recording", "runs"), [(recorded({}), False), (measured("creep/running", [0.2, 0.75]), True)]
)
def test_a_robot_that_is_sampled_every_few_seconds_steps_and_waits(recording, runs):
    terms = explained(recording).search.terms
    assert {("response_lag", "running"), ("creep", "running")}.isdisjoint(
        {(t.name, t.form) for t in terms}
    ) == (not runs)


@pytest.mark.long
def test_a_wire_that_gives_back_what_arrived_is_creep() -> None:
    recording = sagging(0.12, 6.0)
    (diagnosis,) = diagnosed(recording).diagnoses
    assert [p.name for p in diagnosis.physics] == ["creep"]
    assert diagnosis.verdict == "explained"
    told = {p.name: p.value for p in diagnosis.physics[0].parameters}
    assert told["time_constant"] == pytest.approx(6.0, rel=0.25)
    assert diagnosis.after.heldout_rmse < 0.11


def sagging(share: float, late_s: float) -> Recording:
    """A Kelvin element in series with the wire, stepped finely (explicit Euler)."""
    plain, motion = measured("backlash", [0.0]), driven()
    time_s = np.linspace(0.0, motion.time_s[-1], 20 * len(motion))
    asked = np.interp(time_s, motion.time_s, motion.drive)
    late, longer = asked[0], np.empty(len(asked))
    for k, drive in enumerate(asked):
        late += (drive - late) * (time_s[1] - time_s[0]) / late_s
        longer[k] = share * (drive - late)
    sagged = CURVE(motion.drive + np.interp(motion.time_s, time_s, longer)) - CURVE(motion.drive)
    return replace(plain, samples=plain.samples.assign(**{ANGLE: plain.samples[ANGLE] + sagged}))

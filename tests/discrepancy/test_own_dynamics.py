"""A simulation, nearly a curve of its command, that knows that the mechanism is a bit late."""

from dataclasses import replace

import numpy as np
import pytest

from pipeline.discrepancy.explained import better_by_row
from pipeline.discrepancy.fitting.ground import ground_of
from pipeline.discrepancy.noise.noise import NoiseModel
from pipeline.discrepancy.problem.own_dynamics import beside_curve
from pipeline.physics.kinematics import IdentityCurve
from pipeline.physics.motion import Motion
from pipeline.physics.play_operator import play
from tests.discrepancy.made import (
    SIMULATED,
    changed,
    chosen,
    diagnosed,
    explanation_of,
    followed,
    posed,
)

PACE_HZ, LATE_S, NOISE = 0.6, 0.001, 0.05
TIME_S = np.arange(1500) * 0.01
DRIVE = 30.0 * np.sin(2.0 * np.pi * PACE_HZ * TIME_S) + 9.0 * np.sin(2.0 * np.pi * 1.7 * TIME_S)
LATE = np.interp(TIME_S - LATE_S, TIME_S, DRIVE)
SEEN = NOISE * np.random.default_rng(4).standard_normal(1500)


def own(simulated: np.ndarray, measured: np.ndarray, drive: np.ndarray = DRIVE) -> np.ndarray:
    motion = Motion(drive, TIME_S, np.zeros(len(drive), dtype=np.int64))
    found, stays = beside_curve(motion, IdentityCurve(), simulated, measured)
    return found if stays else np.zeros(len(drive))


def test_what_the_measurement_does_as_well_is_the_simulations_own() -> None:
    np.testing.assert_allclose(own(LATE, 1.02 * LATE + 0.3 + SEEN), LATE - DRIVE, atol=1e-12)


@pytest.mark.parametrize(
    ("simulated", "measured", "drive"),
    [
        (LATE, DRIVE + SEEN, DRIVE),
        (DRIVE, LATE + SEEN, DRIVE),
        (DRIVE + 0.02 * (LATE - DRIVE), LATE + SEEN, DRIVE),
        (DRIVE, DRIVE + SEEN, 0.35 * np.round(DRIVE / 0.35)),
    ],
    ids=["not followed", "no dynamics", "unseen", "counts"],
)
def test_it_is_nothing_where_that_is_not_sure(
    simulated: np.ndarray, measured: np.ndarray, drive: np.ndarray
) -> None:
    assert not own(simulated, measured, drive).any()


def test_a_command_that_goes_in_steps_is_exact_though_it_is_on_a_grid() -> None:
    steps = 0.9 * np.abs(np.arange(len(TIME_S)) % 100 - 50.0)
    late = steps - 0.15 * np.diff(steps, prepend=steps[:1])
    motion = Motion(steps, TIME_S, np.zeros(len(steps), dtype=np.int64))
    assert beside_curve(motion, IdentityCurve(), late, 1.02 * late + 0.3 + SEEN)[0].any()


def test_a_lag_that_the_simulation_knows_is_no_mismatch_and_is_said() -> None:
    recording = followed(TIME_S, DRIVE, 1.02 * LATE + 0.3 + SEEN, PACE_HZ)
    (found,) = diagnosed(changed(recording, **{SIMULATED: LATE})).diagnoses
    assert found.verdict == "no_mismatch"
    assert found.after.heldout_rmse < 1.1 * NOISE
    assert any("(RMS) off a curve" in note for note in found.notes)


def test_rows_held_out_do_not_say_what_is_the_simulations_own() -> None:
    measured, other = 1.02 * LATE + 0.3 + SEEN, 1.02 * DRIVE + 0.3 + SEEN
    heldout = posed(followed(TIME_S, DRIVE, measured, PACE_HZ)).heldout
    for late, taken_off in ((~heldout, True), (heldout, False)):
        recording = followed(TIME_S, DRIVE, np.where(late, measured, other), PACE_HZ)
        assert bool(posed(changed(recording, **{SIMULATED: LATE})).own) == taken_off


def test_what_else_is_late_is_told_beside_it() -> None:
    later = np.interp(TIME_S - 3.0 * LATE_S, TIME_S, DRIVE)
    recording = followed(TIME_S, DRIVE, later + SEEN, PACE_HZ)
    (found,) = diagnosed(changed(recording, **{SIMULATED: LATE})).diagnoses
    (physics,) = found.physics
    assert "response_lag" in {physics.name, *physics.alternatives}
    assert found.after.heldout_rmse < 1.1 * NOISE


@pytest.mark.parametrize("late_s", [0.013, 0.03])
@pytest.mark.long
def test_play_that_the_simulation_knows_is_as_late_as_the_rest(late_s: float) -> None:
    knows = play(DRIVE, 0.05, 0.0)
    seen = np.interp(TIME_S - late_s, TIME_S, knows)
    recording = followed(TIME_S, DRIVE, 1.01 * seen + 0.2 + 0.6 * SEEN, PACE_HZ)
    recording = changed(recording, **{SIMULATED: knows})
    problem = posed(recording)
    assert problem.static
    assert problem.own == 0.0
    (found,) = diagnosed(recording).diagnoses
    (physics,) = found.physics
    assert physics.name == "frame_lag"
    assert found.after.heldout_rmse < 1.1 * 0.6 * NOISE


@pytest.mark.parametrize(
    ("score", "rows", "better"),
    [(-1001.0, 0, False), (-1003.0, 0, True), (-996.0, 5, False), (-998.0, 5, True)],
)
def test_a_trace_drives_only_where_it_clearly_explains_more(
    score: float, rows: int, better: bool
) -> None:
    """rows: how many fewer are used, of about 1,000 that are worth 1 each."""
    problem = posed(followed(TIME_S, DRIVE, DRIVE + SEEN, PACE_HZ))
    assert problem.traced is None
    used = problem.train & (np.cumsum(problem.train) <= 1000)
    ground = ground_of(problem, NoiseModel(NOISE), used)
    plain = explanation_of([chosen(ground, -1000.0)])
    fewer = explanation_of([chosen(ground, score)])
    fewer = replace(fewer, used=used & (np.cumsum(used) > rows))
    assert better_by_row(fewer, plain) == better


def test_it_is_its_own_where_samples_are_uneven_too() -> None:
    rng = np.random.default_rng(8)
    time_s = TIME_S + 0.003 * rng.uniform(-1.0, 1.0, len(TIME_S))
    drive, late = (np.interp(time_s - late_s, TIME_S, DRIVE) for late_s in (0.0, 2.0 * LATE_S))
    recording = followed(time_s, drive, 1.02 * late + 0.3 + SEEN, PACE_HZ)
    (found,) = diagnosed(changed(recording, **{SIMULATED: late})).diagnoses
    assert found.verdict == "no_mismatch"

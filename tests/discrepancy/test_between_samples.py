"""Commands that turn between two samples: what follows them has been farther than a sample says."""

from itertools import pairwise

import numpy as np
import pytest

from pipeline.discrepancy.model.model import as_json, from_json
from pipeline.discrepancy.problem.course import course_of
from pipeline.recording import Recording
from pipeline.stages.prediction import predict
from tests.discrepancy.made import SIMULATED, changed, diagnosed, followed, names, value_of

FINE_S, EVERY, LATE_S, NOISE = 0.002, 75, 0.25, 0.03
STROKE_S, REST_S, HIGH, STROKES = 3.07, 0.71, 20.0, 40


def rested_triangle(time_s: np.ndarray) -> np.ndarray:
    """Strokes between two ends, at each of which it rests, of another length each time."""
    rng = np.random.default_rng(3)
    ends = np.where(np.arange(STROKES + 1) % 2, 1.0, -1.0) * rng.uniform(0.6, 1.0, STROKES + 1)
    begins = (STROKE_S + REST_S) * np.arange(STROKES + 1)
    when = np.column_stack([begins, begins + REST_S]).ravel()
    return np.interp(time_s, when, HIGH * np.repeat(ends, 2))


def late(drive: np.ndarray) -> np.ndarray:
    """What follows a drive by small steps, exactly of each straight way between two of them."""
    fade, out = np.exp(-FINE_S / LATE_S), [drive[0]]
    for before, asked in pairwise(drive):
        speed = (asked - before) / FINE_S
        steady = out[-1] - before + speed * LATE_S
        out.append(asked - speed * LATE_S + fade * steady)
    return np.array(out)


FINE = FINE_S * np.arange(round(STROKES * (STROKE_S + REST_S) / FINE_S))
TIME_S, DRIVE = FINE[::EVERY], rested_triangle(FINE)[::EVERY]
LATE = late(rested_triangle(FINE))[::EVERY]


def recorded(seen: np.ndarray) -> Recording:
    noise = NOISE * np.random.default_rng(1).standard_normal(len(seen))
    return followed(TIME_S, DRIVE, seen + noise, 0.5 / (STROKE_S + REST_S))


@pytest.fixture(scope="module")
def moving() -> Recording:
    return recorded(LATE)


def test_a_lag_behind_them_is_all_that_there_is_and_is_foretold(moving):
    told = diagnosed(moving)
    assert names(told) == {"response_lag"}
    assert told.diagnoses[0].verdict == "explained"
    late_s = value_of(told, "response_lag", "time_constant")
    assert late_s.low < LATE_S < late_s.high
    assert told.diagnoses[0].after.heldout_rmse < 1.1 * NOISE
    assert told.models[0].cornered
    again = from_json(as_json(told.models[0]), ["yaw_command_deg"])
    foretold = predict([again], moving).iloc[:, 1].to_numpy()
    assert np.sqrt(np.mean((foretold - LATE) ** 2)) < 0.2 * NOISE


def test_commands_that_are_held_until_the_next_sample_did_not_turn_between():
    held = np.zeros(len(DRIVE)) + DRIVE[0]
    for k in range(1, len(DRIVE)):
        held[k] = DRIVE[k - 1] + (held[k - 1] - DRIVE[k - 1]) * np.exp(-FINE_S * EVERY / LATE_S)
    told = diagnosed(recorded(held))
    assert not told.models[0].cornered
    assert told.diagnoses[0].after.heldout_rmse < 1.1 * NOISE


def test_a_simulation_that_comes_late_behind_them_is_taken_apart(moving):
    found = course_of({"motor": DRIVE}, TIME_S, LATE)
    assert found is not None
    assert found.cornered
    assert found.own.pieces[0].values[0] == pytest.approx(LATE_S, rel=0.01)
    np.testing.assert_allclose(found.reproduced, LATE, atol=0.02)
    slipped = np.where(np.arange(len(LATE)) < len(LATE) // 3, LATE, LATE - 1.0)
    assert names(diagnosed(changed(moving, **{SIMULATED: slipped}))) == {"lost_steps"}

"""Commands that turn between two samples: where they did, and what follows them there."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import sawtooth

from pipeline.physics.catalogue import term
from pipeline.physics.corners import corners_in, corners_of
from pipeline.physics.mechanism import Mechanism
from pipeline.physics.motion import Motion
from pipeline.physics.piece import Piece

PERIOD_S, STEP_S, ROWS, HIGH = 7.3, 0.1, 400, 20.0
TIME_S = STEP_S * np.arange(ROWS)
TURNS_S = np.arange(0.5, 11.0, 0.5) * PERIOD_S
TURNS_S = TURNS_S[::2]  # the others are at samples
TURNS_S = TURNS_S[: np.searchsorted(TURNS_S, TIME_S[-3])]


def triangle(time_s: np.ndarray) -> np.ndarray:
    return np.asarray(HIGH * sawtooth(2.0 * np.pi * time_s / PERIOD_S, 0.5))


def motion_at(time_s: np.ndarray) -> Motion:
    cycle = (time_s // PERIOD_S).astype(np.int64)
    return Motion(triangle(time_s), time_s, cycle, {"other": np.sin(time_s)})


def test_a_triangle_turns_where_its_straight_lines_meet():
    when, values = corners_in(TIME_S, triangle(TIME_S))
    np.testing.assert_allclose(when, TURNS_S, atol=1e-9)
    np.testing.assert_allclose(np.abs(values), HIGH, atol=1e-9)


def test_a_stop_between_uneven_samples_is_found():
    time_s = np.cumsum(np.random.default_rng(1).uniform(0.5, 1.5, 200)) * STEP_S
    ramp = np.minimum(3.0 * time_s, 20.0)
    when, values = corners_in(time_s, ramp)
    assert when == pytest.approx([20.0 / 3.0])
    assert values == pytest.approx([20.0])


@pytest.mark.parametrize(
    "signal",
    [
        HIGH * np.sin(TIME_S),
        np.repeat(np.arange(ROWS // 10) % 7, 10).astype(float),
        HIGH * sawtooth(2.0 * np.pi * TIME_S / 8.0, 0.5),
        np.random.default_rng(0).standard_normal(ROWS).cumsum(),
        3.0 * np.round(triangle(TIME_S) / 3.0),
        np.zeros(ROWS),
        np.arange(5.0),
    ],
    ids=["wave", "stairs", "turns at samples", "wander", "coarsely read", "still", "short"],
)
def test_what_bends_all_the_time_is_held_or_turns_at_samples_has_no_corners(signal):
    assert len(corners_in(TIME_S[: len(signal)], signal)[0]) == 0


@pytest.mark.parametrize(
    ("name", "form", "values"), [("backlash", "", [3.0]), ("response_lag", "running", [0.4])]
)
def test_what_remembers_a_way_answers_as_on_the_whole_of_it(name, form, values):
    coarse, fine = motion_at(TIME_S), motion_at(np.unique(np.concatenate([TIME_S, TURNS_S])))
    cornered = replace(coarse, corners=corners_of(TIME_S, coarse.drive, coarse.others))
    mechanism = Mechanism(pieces=[Piece(term(name, form, []), np.array(values))])
    wanted = mechanism.respond(fine)[0][np.searchsorted(fine.time_s, TIME_S)]
    np.testing.assert_allclose(mechanism.respond(cornered)[0], wanted, atol=1e-9)
    assert np.abs(mechanism.respond(coarse)[0] - wanted).max() > 0.05


def test_rows_of_a_motion_keep_the_corners_between_them():
    whole = motion_at(TIME_S)
    whole = replace(whole, corners=corners_of(TIME_S, whole.drive, whole.others))
    part, rows = whole.rows(np.arange(50, 200, 3)).whole
    before, after = np.searchsorted(TURNS_S, TIME_S[[50, 197]])
    assert len(part) == 50 + after - before
    np.testing.assert_array_equal(part.time_s[rows], TIME_S[50:200:3])
    np.testing.assert_array_equal(np.diff(part.time_s) > 0.0, True)
    assert np.abs(part.drive).max() == pytest.approx(HIGH)

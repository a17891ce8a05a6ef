"""Frames that show an earlier pose now and then, or are frozen for a while."""

import numpy as np
import pytest

from pipeline.discrepancy.problem.late import OVERWHELMING, late_frames, poses_learnt
from tests.discrepancy.made import (
    ANGLE,
    NOISE,
    SIMULATED,
    changed,
    diagnosed,
    names,
    recorded,
    value_of,
)

CYCLES, ROWS = 6, 200
POSE = np.tile(np.interp(np.arange(ROWS), [0, 50, 150, 200], [0, 50, -50, 0]), CYCLES)
N = len(POSE)
CYCLE = np.arange(N) // ROWS
EVERY = np.ones(N, dtype=bool)


def measured(off: np.ndarray) -> np.ndarray:
    return POSE + off + 0.25 * np.random.default_rng(1).standard_normal(N)


def found(off: np.ndarray, repeats: tuple[np.ndarray, ...] = ()) -> np.ndarray:
    return late_frames(measured(off), POSE, EVERY, 1e-9, CYCLE, repeats).late


def behind(by: np.ndarray) -> np.ndarray:
    """How far poses that are some samples late (n,) are off their own."""
    return POSE[np.maximum(np.arange(N) - by, 0)] - POSE


@pytest.mark.parametrize(("frames", "share"), [(1, 0.3), (2, 0.1), (3, 0.06)])
def test_frames_that_are_late_at_random_are_found(frames: int, share: float) -> None:
    by = np.where(np.random.default_rng(2).random(N) < share, frames, 0)
    by[:5] = 0
    assert np.mean(found(behind(by)) == by) > 0.97


@pytest.mark.parametrize("share", [0.25, 0.4, 0.7])
def test_frames_are_found_late_where_a_fit_took_their_mean_for_a_lag(share: float) -> None:
    by = (np.random.default_rng(2).random(N) < share).astype(int)
    lagging = POSE - share * np.diff(POSE, prepend=0.0)
    told = late_frames(measured(behind(by)), lagging, EVERY, 1e-9, CYCLE)
    usual = int(share > 0.5)
    assert np.mean(told.late[~told.unsure] == (by - usual)[~told.unsure]) > 0.95
    assert np.mean(told.since(told.late != 0) > 0) == pytest.approx(1.0 - usual, abs=0.01)


def test_frames_that_are_frozen_for_a_while_are_found_late_and_later() -> None:
    by = np.zeros(N, dtype=int)
    for first in np.random.default_rng(3).choice(N // 12, 25, replace=False) * 12 + 6:
        by[first : first + 5] = np.arange(5)
    assert np.mean(found(behind(by)) == by) > 0.97


@pytest.mark.parametrize(
    "off",
    [
        np.zeros(N),
        2.0 * (np.random.default_rng(4).random(N) < 0.08),
        np.where(np.arange(N) > 600, behind(np.full(N, 2)), 0.0),
        -0.5 * np.gradient(POSE),
    ],
    ids=["noise", "mistaken to one side", "late from a moment on", "all a little late"],
)
def test_what_is_no_late_frame_is_none(off: np.ndarray) -> None:
    assert not found(off).any()


@pytest.mark.parametrize("steps", [0.8, 1.0, 1.5, 2.0])
def test_noise_of_about_a_step_is_no_late_frame(steps: float) -> None:
    rng = np.random.default_rng(6)
    for _ in range(20):
        noisy = POSE + rng.standard_normal(N) / steps
        assert not late_frames(noisy, POSE, EVERY, 1e-9, CYCLE).aside.any()


def test_what_lags_at_the_same_steps_of_each_cycle_is_the_mechanism() -> None:
    by = np.where(np.isin(np.arange(N) % ROWS, np.arange(60, 140, 6)), 3, 0)
    assert found(behind(by)).any()
    assert not found(behind(by), (np.arange(N).reshape(CYCLES, ROWS),)).any()


def test_a_diagnosis_names_frames_of_which_every_other_is_late_by_chance() -> None:
    recording = recorded({})
    pose = recording.values(SIMULATED)
    late = np.random.default_rng(5).random(len(pose)) < 0.4
    late[:2] = False
    moved = (np.roll(pose, 1) - pose) * np.ptp(recording.values(ANGLE)) / np.ptp(pose)
    angle = recording.values(ANGLE) + np.where(late, moved, 0.0)
    result = diagnosed(changed(recording, **{ANGLE: angle}))
    assert names(result) == {"frame_lag"}
    assert value_of(result, "frame_lag", "share").value == pytest.approx(late.mean(), abs=0.05)
    assert result.diagnoses[0].after.heldout_rmse < 1.15 * NOISE


def test_a_diagnosis_names_frames_that_are_late_now_and_then() -> None:
    recording = recorded({})
    angle, pose = recording.values(ANGLE).copy(), recording.values(SIMULATED)
    rows = np.flatnonzero(np.random.default_rng(5).random(len(angle)) < 0.12)
    rows = rows[rows >= 2]
    angle[rows] += (pose[rows - 2] - pose[rows]) * np.ptp(angle) / np.ptp(pose)
    result = diagnosed(changed(recording, **{ANGLE: angle}))
    assert names(result) == {"frame_lag"}
    assert value_of(result, "frame_lag", "lag").value == pytest.approx(2.0, abs=0.1)
    assert result.diagnoses[0].after.heldout_rmse < 1.15 * NOISE


@pytest.mark.parametrize("seed", range(3))
def test_mistaken_markers_are_no_evidence_of_late_frames(seed: int) -> None:
    """They are off to either side by as much as some poses are; late ones to one side."""
    rng = np.random.default_rng(seed)
    hit = rng.random(N) < 0.03
    off = hit * rng.choice([-1.0, 1.0], N) * rng.uniform(2.0, 7.0, N)
    noisy = POSE + off + rng.standard_normal(N)
    assert poses_learnt(noisy, POSE, EVERY, 1e-9).likelier() < 0.3 * OVERWHELMING
    by = (rng.random(N) < 0.3).astype(int)
    late = measured(behind(by))
    assert poses_learnt(late, POSE, EVERY, 1e-9).likelier() > OVERWHELMING

"""Errors that spread from a place on come of a gain that changes, and are no zero that wanders."""

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d

from pipeline.discrepancy.judgement.fanning import even_by_chance
from tests.discrepancy.made import ANGLE, STEPS, changed, diagnosed, motion_of, recorded

CYCLES = 9
DRIVE = motion_of(CYCLES).drive


def smooth(seed: int, width: float) -> np.ndarray:
    """What goes to and fro at random, of size 1 (RMS); width: over the cycle."""
    steps = np.random.default_rng(seed).standard_normal(len(DRIVE))
    course = gaussian_filter1d(steps, width * STEPS)
    return course / np.std(course)


def switched(seed: int) -> np.ndarray:
    """1 or -1, changed now and then."""
    turns = np.sort(np.random.default_rng(seed).uniform(0.0, len(DRIVE), 14))
    return np.where(np.searchsorted(turns, np.arange(len(DRIVE))) % 2, 1.0, -1.0)


@pytest.mark.parametrize("width", [0.1, 0.25, 0.6, 2.0])
def test_a_zero_spreads_evenly_whatever_its_pace(width):
    chances = [even_by_chance(DRIVE, smooth(seed, width)) for seed in range(20)]
    assert min(chances) > 1e-3


@pytest.mark.parametrize("middle", [0.0, -15.0, 40.0])
def test_a_gain_that_is_switched_spreads_from_its_middle_on(middle):
    noise = 0.1 * np.random.default_rng(1).standard_normal(len(DRIVE))
    off = 0.05 * switched(2) * (DRIVE - middle) + noise
    assert even_by_chance(DRIVE, off) < 1e-3
    off[::2] = np.nan
    assert even_by_chance(DRIVE, off) < 1e-3


def test_few_passages_say_nothing():
    assert even_by_chance(DRIVE[: 2 * STEPS], DRIVE[: 2 * STEPS]) == 1.0


@pytest.mark.parametrize(("seed", "width"), [(1, 0.12), (17, 0.2)])
def test_a_pose_dependence_that_changes_unseen_is_no_drift(seed, width):
    recording = recorded({}, cycles=CYCLES)
    unseen = gaussian_filter1d(switched(seed), width * STEPS)
    off = 1.2 * unseen * np.tanh((DRIVE + 10.0) / 25.0)
    (told,) = diagnosed(changed(recording, **{ANGLE: recording.values(ANGLE) + off})).diagnoses
    assert told.verdict == "unknown_physics"

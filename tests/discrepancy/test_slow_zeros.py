"""Courses that a zero takes, in laws that are written here."""

import numpy as np
import pytest

from tests.discrepancy.made import ANGLE, NOISE, changed, diagnosed, names, recorded


def warming(hours: np.ndarray, cycle: np.ndarray) -> np.ndarray:
    """A room that warms up while the sun comes and goes, each with a third of the time."""
    share = hours / hours[-1]
    return 1.5 * share + 0.5 * np.sin(2.0 * np.pi * share / 0.34)


def settling(hours: np.ndarray, cycle: np.ndarray) -> np.ndarray:
    """A wire that beds in from cycle to cycle."""
    return 1.2 * (1.0 - np.exp(-cycle / 1.7))


def shaded(hours: np.ndarray, cycle: np.ndarray) -> np.ndarray:
    """A mount in and out of the sun, by two periods of which none is the other's."""
    share = hours / hours[-1]
    return np.sin(2.0 * np.pi * share / 0.38 + 1.0) + np.sin(2.0 * np.pi * share / 0.63 + 3.0)


COURSES = [(warming, "rising wave"), (settling, "settling cycle"), (shaded, "smooth")]


@pytest.mark.parametrize(("zero", "form"), COURSES)
@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.long
def test_a_zero_that_follows_its_own_course_is_one_drift(zero, form, seed):
    recording = recorded({}, cycles=9, seed=seed)
    hours = recording.samples["time_s"].to_numpy() / 3600.0
    moved = recording.samples[ANGLE] + zero(hours, recording.samples["cycle"].to_numpy())
    result = diagnosed(changed(recording, **{ANGLE: moved}))
    (diagnosis,) = result.diagnoses
    assert names(result) == {"drift"}
    assert [p.term.form for p in result.models[0].mechanism.pieces] == [form]
    foretold = 1.1 * NOISE if form != "smooth" else 0.5 * diagnosis.before.heldout_rmse
    assert diagnosis.after.heldout_rmse < foretold

"""Frames that wait in a queue, and teeth and wheels out of true, in diagnoses."""

import numpy as np
import pytest

from pipeline.discrepancy.search.queued import queued
from tests.discrepancy.made import ANGLE, NOISE, SIMULATED, changed, explained, recorded

EVERY, FLUSHED_AT = 130, 40


def queue_of(rise: float) -> np.ndarray:
    """A recording's poses, noisy, each as the buffer shows it that is flushed every 130 frames."""
    recording = recorded({}, cycles=9)
    pose = recording.values(SIMULATED)
    rows = np.arange(len(pose))
    late = np.round(rise * ((rows + FLUSHED_AT) % EVERY) / EVERY).astype(int)
    noise = NOISE * np.random.default_rng(7).standard_normal(len(pose))
    return changed(recording, **{ANGLE: pose[np.maximum(rows - late, 0)] + noise})


@pytest.mark.parametrize("rise", [1.0, 4.0])
def test_frames_from_a_buffer_that_fills_and_is_flushed_are_told(rise):
    best = explained(queue_of(rise)).choices[0]
    (piece,) = best.fit.pieces
    assert (piece.term.name, piece.term.form) == ("frame_lag", "queue")
    assert piece.values[1] == pytest.approx(EVERY, rel=0.01)
    assert piece.values[2] == pytest.approx(FLUSHED_AT / EVERY, abs=0.02)
    assert best.fit.ground.noise.deviation < 1.1 * NOISE


@pytest.mark.parametrize(
    "hidden",
    [{"backlash": {"width": 2.0}}, {"frame_lag": {"lag": 4.0}}, {"creep": {"share": 0.2}}],
    ids=lambda h: next(iter(h)),
)
def test_what_comes_late_at_a_steady_pace_is_no_queue(hidden):
    found = explained(recorded(hidden, cycles=9))
    assert queued(found.search, found.choices[0]) is found.choices[0]


@pytest.mark.parametrize(
    ("form", "values"),
    [
        ("swelling afloat", {"amplitude": 0.8, "period": 9.0, "swell": 0.6, "swell_period": 70.0}),
        ("eccentric afloat", {"amplitude": 2.5, "period": 45.0, "eccentricity": -0.45}),
    ],
)
def test_a_ripple_out_of_true_is_named_alone(form, values):
    best = explained(recorded({f"transmission_ripple/{form}": values}, cycles=9)).choices[0]
    assert [(p.term.name, p.term.form) for p in best.fit.pieces] == [("transmission_ripple", form)]

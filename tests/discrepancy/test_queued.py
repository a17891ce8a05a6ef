"""Frames that wait in a queue that is emptied again and again."""

import numpy as np
import pytest

from pipeline.discrepancy.search.queued import queued
from pipeline.recording import Recording
from tests.discrepancy.made import (
    ANGLE,
    NOISE,
    SIMULATED,
    changed,
    diagnosed,
    explained,
    recorded,
)

EVERY, FLUSHED_AT = 130, 40


def queue_of(rise: float) -> Recording:
    """A recording's poses, noisy, each as the buffer shows it that is flushed every 130 frames."""
    recording = recorded({}, cycles=9)
    pose = recording.values(SIMULATED)
    rows = np.arange(len(pose))
    late = np.round(rise * ((rows + FLUSHED_AT) % EVERY) / EVERY).astype(int)
    noise = NOISE * np.random.default_rng(7).standard_normal(len(pose))
    return changed(recording, **{ANGLE: pose[np.maximum(rows - late, 0)] + noise})


@pytest.mark.parametrize("rise", [1.0, 4.0])
@pytest.mark.long
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


@pytest.mark.long
def test_a_queue_is_the_same_as_nothing_steady_and_says_how_often_it_is_emptied():
    (physics,) = diagnosed(queue_of(4.0)).diagnoses[0].physics
    assert (physics.name, physics.alternatives) == ("frame_lag", ())
    assert "every 130 frames" in physics.says

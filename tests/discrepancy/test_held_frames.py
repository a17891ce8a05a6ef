"""Frames that are about a wait old: after short waits they show the pose before, else a move."""

import numpy as np
import pytest

from pipeline.physics.frame_lag import held_at
from tests.discrepancy.made import ANGLE, STEPS, changed, diagnosed, names, recorded, value_of

USUAL_S, SHORT_S, OLD_S, MOVE_S = 3.3, 1.9, 3.15, 0.5


@pytest.mark.parametrize(
    "loop", [{"friction": {"width": 8.0, "reach": 3.0}}, {"backlash": {"width": 8.0}}]
)
def test_old_frames_beside_a_loop_are_told_where_waits_differ(loop):
    recording = recorded(loop, cycles=9, seed=1, noise=0.0)
    rows = np.arange(len(recording.samples))
    time_s = np.cumsum(np.where(rows // STEPS % 3 == 1, SHORT_S, USUAL_S))
    seen = held_at(time_s - OLD_S, time_s, recording.values(ANGLE), MOVE_S)
    seen += 0.15 * np.random.default_rng(1).standard_normal(len(rows))
    told = diagnosed(changed(recording, **{"time_s": time_s, ANGLE: seen}))
    assert names(told) == {"frame_lag", *loop}
    old_s, move_s = (value_of(told, "frame_lag", p).value for p in ("lag", "move"))
    assert (USUAL_S - old_s) / move_s == pytest.approx((USUAL_S - OLD_S) / MOVE_S, abs=0.03)

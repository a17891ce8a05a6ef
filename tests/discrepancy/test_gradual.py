"""A zero that moved on gradually while rows were held out did not slip there."""

import numpy as np
import pytest

from pipeline.discrepancy.judgement.gradual import left_by_levels, left_by_line
from tests.discrepancy.made import diagnosed, followed, names

PACE_HZ, STEP_S, NOISE, ROWS, JUMP = 0.25, 0.02, 0.3, 2400, 3.0
TIME_S = np.arange(ROWS) * STEP_S
TURN = 2.0 * np.pi * PACE_HZ * TIME_S
DRIVE = 20.0 * np.sin(TURN) + 5.0 * np.sin(3.0 * TURN + 0.4)
HELD_OUT_S = (20.0, 24.0)  # the sixth cycle


@pytest.mark.parametrize(
    ("lasts_s", "found"), [(0.02, {"lost_steps"}), (3.6, set()), (0.2, {"lost_steps"})]
)
def test_only_what_jumps_among_held_out_rows_is_a_slip(lasts_s, found):
    middle_s = 0.5 * sum(HELD_OUT_S)
    way = np.clip(0.5 + (TIME_S - middle_s) / lasts_s, 0.0, 1.0)
    noise = NOISE * np.random.default_rng(4).standard_normal(ROWS)
    told = diagnosed(followed(TIME_S, DRIVE, DRIVE + JUMP * way + noise, PACE_HZ))
    assert names(told) & {"lost_steps"} == found
    (model,) = told.models
    gone = [p for p in model.mechanism.pieces if p.term.name == "lost_steps"]
    assert bool(gone) is bool(found)


def test_a_way_is_told_from_a_jump_whatever_the_level():
    time_s = np.linspace(0.0, 4.0, 120)
    noise = 0.2 * np.random.default_rng(1).standard_normal(120)
    jump = np.full(120, JUMP)
    for level in (0.0, 1.5):
        step, way = (level + JUMP * moved + noise for moved in (time_s > 2.7, time_s / 4.0))
        assert left_by_levels(step, jump) == pytest.approx(np.sum(noise**2), rel=0.1)
        assert left_by_line(time_s, way) == pytest.approx(np.sum(noise**2), rel=0.1)
        assert left_by_levels(way, jump) > 10.0 * left_by_line(time_s, way)
        assert left_by_line(time_s, step) > 5.0 * left_by_levels(step, jump)

"""An answer that runs ahead of its command is more than any name says, though creep is near."""

import numpy as np
import pytest

from pipeline.physics.loaded_wire import AHEAD, LoadedWire
from pipeline.physics.term import Surroundings
from pipeline.physics.yielding_wire import YieldingWire
from tests.discrepancy.made import diagnosed, followed

PACE_HZ, STEP_S, NOISE, ROWS = 0.25, 0.02, 0.1, 2400
TIME_S = np.arange(ROWS) * STEP_S


def driven(time_s: np.ndarray) -> np.ndarray:
    turn = 2.0 * np.pi * PACE_HZ * time_s
    return np.asarray(20.0 * np.sin(turn) + 5.0 * np.sin(3.0 * turn + 0.4))


DRIVE = driven(TIME_S)


@pytest.mark.parametrize(
    ("lead_s", "early"),
    [(0.01, True), (0.03, True), (0.01, False)],
    ids=["clocks off", "far off", "overshoots"],
)
def test_an_answer_ahead_of_its_command_is_more_than_a_name(lead_s, early):
    ahead = driven(TIME_S + lead_s) if early else DRIVE + lead_s * np.gradient(DRIVE, TIME_S)
    noise = NOISE * np.random.default_rng(3).standard_normal(ROWS)
    (told,) = diagnosed(followed(TIME_S, DRIVE, ahead + noise, PACE_HZ)).diagnoses
    assert told.verdict == "partly_explained"
    assert [p.name for p in told.physics] == ["frame_lag"]
    assert [e.value for e in told.physics[0].parameters] == [pytest.approx(lead_s, rel=0.1)]
    assert "ahead" in (told.unexplained.where or "")
    assert told.after.heldout_rmse < 1.1 * NOISE


@pytest.mark.parametrize("term", [LoadedWire(), YieldingWire()], ids=["loaded", "yielding"])
@pytest.mark.parametrize(
    ("late_s", "dwell_s", "said"), [(0.025, 0.02, AHEAD), (0.2, 0.02, ""), (4.0, 3.0, "")]
)
def test_a_wire_that_sags_within_a_sample_is_none_but_where_a_robot_waits(
    term, late_s, dwell_s, said
):
    around = Surroundings(dwell_s=dwell_s)
    values = np.array([p.start for p in term.parameters(around)])
    values[1] = late_s
    assert term.beyond_at(values, around) == said

"""A simulation has too much or too little of what it has: that is said, and nothing else."""

import numpy as np
import pytest

from pipeline.discrepancy.model.model import as_json, from_json
from pipeline.physics.play_operator import play
from tests.discrepancy.made import names, value_of
from tests.discrepancy.test_course import (
    DRIVE,
    LATE_S,
    NOISE,
    WIDTH,
    crept,
    curved,
    diagnosed,
    late,
    played,
    real,
)


def slid(factor: float) -> np.ndarray:
    """A drive held back by sliders as stiff, which slip at `factor` times the force."""
    most, stiff = np.full(12, 0.15 * factor), 0.15 / np.linspace(1.0, 8.0, 12)
    held, out = np.zeros(12), np.empty(len(DRIVE))
    for i, step in enumerate(np.diff(DRIVE, prepend=DRIVE[0])):
        held = np.clip(held + stiff * step, -most, most)
        out[i] = DRIVE[i] - held.sum()
    return curved(out)


def much_less() -> np.ndarray:
    return late(curved(play(DRIVE, 0.25 * WIDTH, DRIVE[0])))


@pytest.mark.parametrize(
    ("simulated", "clean", "name", "size", "value"),
    [
        pytest.param(curved(played(DRIVE)), curved(play(DRIVE, 0.25 * WIDTH, DRIVE[0])),
                     "backlash", "width", -0.5 * WIDTH, id="less play"),
        pytest.param(late(curved(DRIVE)), late(curved(DRIVE), 0.5 * LATE_S),
                     "response_lag", "time_constant", -0.5 * LATE_S, id="less lag"),
        pytest.param(slid(1.0), slid(0.5), "friction", "width", -1.8, id="less friction"),
        pytest.param(slid(1.0), slid(1.5), "friction", "width", 1.8, id="more friction",
                     marks=pytest.mark.long),
        pytest.param(crept(curved(DRIVE)), 0.9 * curved(DRIVE) + 0.1 * late(curved(DRIVE), 0.8),
                     "creep", "share", -0.1, id="less creep", marks=pytest.mark.long),
        pytest.param(late(curved(played(DRIVE))), much_less(),
                     "backlash", "width", -0.5 * WIDTH, id="less play before a lag",
                     marks=pytest.mark.long),
        pytest.param(late(curved(played(DRIVE))), late(curved(played(DRIVE)), 0.5 * LATE_S),
                     "response_lag", "time_constant", -0.5 * LATE_S, id="less lag behind play",
                     marks=pytest.mark.long),
    ],
)  # fmt: skip
def test_more_or_less_of_what_the_simulation_has_is_told_as_that(
    simulated, clean, name, size, value
):
    found = diagnosed(real(simulated, clean))
    (diagnosis,), (model,), (evidence,) = found.diagnoses, found.models, found.evidence
    assert diagnosis.verdict == "explained"
    assert names(found) == {name}
    assert value_of(found, name, size).value == pytest.approx(value, rel=0.05)
    assert diagnosis.after.heldout_rmse < 1.1 * NOISE
    assert diagnosis.physics[0].surplus is (value < 0)
    assert f"too {'much' if value < 0 else 'little'}" in diagnosis.physics[0].says
    stored = from_json(as_json(model), ["yaw_command_deg"])
    np.testing.assert_array_equal(stored.predict(evidence.motion)[0], evidence.after)

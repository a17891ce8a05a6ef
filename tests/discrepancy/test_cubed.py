"""A coupling that bends as a cubic: its gain and square leave a rest that undoes the name."""

import pytest

from pipeline.discrepancy.search.cubed import cubed
from tests.discrepancy.made import diagnosed, explained, names, recorded

CUBIC = {"coupling/yaw_command_deg/cubic": {"gain": 0.02, "bend": 0.0, "cubic": 4e-5}}


@pytest.fixture(scope="module")
def curved():
    return recorded(CUBIC, two_axes=True)


def test_its_cube_is_found(curved):
    found = diagnosed(curved)
    assert names(found) == {"coupling"}
    assert found.diagnoses[0].verdict == "explained"
    (coupling,) = found.diagnoses[0].physics
    cube = next(p for p in coupling.parameters if p.name == "cubic")
    assert cube.value == pytest.approx(4e-5, rel=0.2)


def test_one_that_bends_less_keeps_its_form():
    plain = {"coupling/yaw_command_deg": {"gain": 0.05, "bend": 0.0}}
    explanation = explained(recorded(plain, two_axes=True))
    best = explanation.choices[0]
    assert cubed(explanation.search, explanation.choices) == explanation.choices
    assert "cubic" not in best.fit.pieces[0].term.form

"""A shaft that slipped slips again in rows that nothing was fitted to."""

import numpy as np
import pytest

from pipeline.discrepancy.fitting.ground import ground_of
from pipeline.discrepancy.judgement.rivals import mechanism_of
from pipeline.discrepancy.judgement.slipped_again import Slip, slipped_again
from pipeline.discrepancy.noise.noise import NoiseModel
from pipeline.discrepancy.search.weighing import Choice
from tests.discrepancy.made import NOISE, STEPS, chosen, diagnosed, names, posed, recorded

FIRST = {"jump": 2.0, "time": 1200.0}
AGAIN_S = 3.36 * (8 * STEPS + 40)
TWICE = FIRST | {"jump_2": -3.0, "time_2": AGAIN_S}


def looked_at(hidden: dict[str, float], **pieces: list[float]) -> tuple[Choice, Slip | None]:
    """A choice of these pieces about a recording with slips, and the slip found after its rows."""
    problem = posed(recorded({"lost_steps/twice": hidden}, cycles=9, gain=1.0, offset=0.0))
    ground = ground_of(problem, NoiseModel(NOISE), problem.train)
    choice = chosen(ground, 0.0, **pieces)
    predicted = mechanism_of(problem, choice).respond(problem.motion)[0]
    return choice, slipped_again(problem, choice, predicted)


def test_the_slip_after_the_last_row_fitted_is_found_and_foretold_from_then_on():
    choice, found = looked_at(TWICE, lost_steps=list(FIRST.values()))
    assert found is not None
    jump, time_s = found.piece.values
    assert jump == pytest.approx(-3.0, rel=0.05)
    assert time_s == pytest.approx(AGAIN_S, abs=10.0)
    problem = choice.fit.ground.problem
    last = np.flatnonzero(problem.heldout)[-70:]
    assert np.std((problem.measured - found.predicted)[last]) < 1.3 * NOISE


def test_what_cannot_move_is_not_said_to_have_slipped():
    blocked = looked_at(TWICE, lost_steps=list(FIRST.values()), end_stop=[-80.0, 0.01, 0.02])
    assert blocked[1] is None


def test_nothing_slips_again_where_nothing_did_or_no_slip_is_named():
    once = FIRST | {"jump_2": 0.0, "time_2": 100.0}
    assert looked_at(once, lost_steps=list(FIRST.values()))[1] is None
    assert looked_at(TWICE, drift=[0.1])[1] is None


def test_a_slip_in_the_last_held_out_cycle_refutes_no_slips():
    result = diagnosed(recorded({"lost_steps/twice": TWICE}, cycles=9))
    assert names(result) == {"lost_steps"}
    assert result.diagnoses[0].verdict == "explained"
    assert any("slips once more, by 3" in note for note in result.diagnoses[0].notes)


def test_a_slip_somewhere_in_held_out_rows_is_said_with_what_the_others_err_by():
    within = 3.0 + 3.36 * (2 * STEPS + 60)  # of a cycle that lasts from 809 s to 1213 s
    result = diagnosed(recorded({"lost_steps/once": {"jump": 3.0, "time": within}}))
    assert names(result) == {"lost_steps"}
    found = result.diagnoses[0]
    (said,) = [note for note in found.notes if "somewhere in held-out rows" in note]
    assert found.after.heldout_rmse > 2.0 * NOISE
    assert "from 813 s to 1209 s" in said
    assert "The other held-out rows err by 0.19" in said

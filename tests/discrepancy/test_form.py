"""Names that explain so little of a mismatch that they are the form of the others."""

from dataclasses import replace

import numpy as np
import pytest

from pipeline.config import DiagnosisConfig
from pipeline.discrepancy.fitting.fit import evaluate, improve
from pipeline.discrepancy.judgement.form import names_of_form, one_for_many
from pipeline.physics.catalogue import term
from pipeline.physics.mechanism import Piece
from pipeline.stages.diagnosis import diagnose
from tests.discrepancy.made import explained, recorded

RIPPLE = term("transmission_ripple")


@pytest.mark.parametrize(("amplitude", "formal"), [(0.05, {RIPPLE.name}), (0.2, set())])
def test_what_explains_less_than_a_hundredth_of_a_mismatch_is_its_form(amplitude, formal):
    ripple = {"amplitude": amplitude, "period": 30.0, "phase": 1.0}
    hidden = {"backlash": {"width": 12.0}, RIPPLE.name: ripple}
    found = explained(recorded(hidden, noise=0.01, seed=1))
    ground = next(c for c in found.choices if "backlash" in c.fit.names).fit.ground
    play = Piece(term("backlash"), np.array([12.0]))
    both = improve(evaluate(ground, [play, Piece(RIPPLE, np.array([amplitude, 30.0, 1.0]))]))
    best = replace(found.choices[0], fit=both)
    assert set(names_of_form(found, best)) == formal


def test_the_only_name_is_no_form_however_little_it_explains():
    found = explained(recorded({"backlash": {"width": 12.0}}, seed=1))
    assert not names_of_form(found, found.choices[0])


def test_a_name_of_form_is_told_in_the_notes_and_stays_in_the_corrected_simulation():
    ripple = {"amplitude": 0.05, "period": 30.0, "phase": 1.0}
    seen = recorded({"backlash": {"width": 12.0}, RIPPLE.name: ripple}, noise=0.01, seed=1)
    (found,) = diagnose(DiagnosisConfig(), seen).diagnoses
    assert [p.name for p in found.physics] == ["backlash"]
    assert any(RIPPLE.name in note and "form of what is named" in note for note in found.notes)
    assert found.after.heldout_rmse < 1.1 * 0.01


@pytest.mark.parametrize(("amplitude", "alone"), [(0.04, True), (1.0, False)])
def test_one_name_that_leaves_hardly_more_is_told_instead_of_a_pile(amplitude, alone):
    ripple = {"amplitude": amplitude, "period": 30.0, "phase": 1.0}
    hidden = {"backlash": {"width": 12.0}, RIPPLE.name: ripple}
    found = explained(recorded(hidden, noise=0.01, seed=1))
    single = next(c for c in found.choices if c.fit.names == ("backlash",))
    pieces = [
        *single.fit.pieces,
        Piece(RIPPLE, np.array([amplitude, 30.0, 1.0])),
        Piece(term("drift"), np.array([1e-3])),
    ]
    pile = replace(single, fit=improve(evaluate(single.fit.ground, pieces)), score=-1e6)
    told = one_for_many(replace(found, choices=[pile, *found.choices]), pile)
    assert told is (single if alone else pile)
    both = replace(pile, fit=evaluate(single.fit.ground, pieces[:2]))
    assert one_for_many(found, both) is both

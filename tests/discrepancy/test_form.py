"""Names that explain so little of a mismatch that they are the form of the others."""

from dataclasses import replace

import numpy as np
import pytest

from pipeline.discrepancy.fitting.fit import evaluate, improve
from pipeline.discrepancy.judgement.form import without_form
from pipeline.physics.catalogue import term
from pipeline.physics.mechanism import Piece
from tests.discrepancy.made import explained, recorded

RIPPLE = term("transmission_ripple")


@pytest.mark.parametrize(("amplitude", "stays"), [(0.1, False), (1.0, True)])
def test_what_explains_less_than_three_hundredths_of_a_mismatch_is_its_form(amplitude, stays):
    ripple = {"amplitude": amplitude, "period": 30.0, "phase": 1.0}
    hidden = {"backlash": {"width": 12.0}, "transmission_ripple": ripple}
    found = explained(recorded(hidden, noise=0.02, seed=1))
    ground = next(c for c in found.choices if "backlash" in c.fit.names).fit.ground
    play = Piece(term("backlash"), np.array([12.0]))
    both = improve(evaluate(ground, [play, Piece(RIPPLE, np.array([amplitude, 30.0, 1.0]))]))
    best = replace(found.choices[0], fit=both)
    assert set(without_form(found, best).fit.names) == {"backlash"} | (
        {RIPPLE.name} if stays else set()
    )


def test_the_only_name_stays_however_little_it_explains():
    found = explained(recorded({"backlash": {"width": 12.0}}, seed=1))
    assert without_form(found, found.choices[0]) is found.choices[0]

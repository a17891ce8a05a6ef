"""Ripples of teeth and wheels that run out of true, in an explanation."""

import numpy as np
import pytest

from pipeline.physics.off_centre_ripple import OffCentreRipple
from pipeline.physics.term import Surroundings
from tests.discrepancy.made import explained, recorded


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


def test_teeth_whose_overtones_go_their_own_way_are_no_wheel_off_its_centre():
    waves = {"amplitude": 2.0, "period": 12.0, "amplitude_2": 0.45, "phase_2": 2.6}
    overtones = {"amplitude_3": 0.35, "phase_3": 5.9}
    hidden = {"transmission_ripple/both afloat": {**waves, **overtones}}
    best = explained(recorded(hidden, cycles=9)).choices[0]
    (piece,) = best.fit.pieces
    assert piece.term.form == "both afloat"
    assert piece.values[[0, 3, 5]] == pytest.approx([2.0, 0.45, 0.35], abs=0.05)


@pytest.mark.parametrize(
    ("off", "period", "slight"), [(0.8, 60.0, True), (0.8, 30.0, False), (0.3, 60.0, False)]
)
def test_an_edge_that_the_drive_meets_less_than_three_times_is_no_ripple(off, period, slight):
    around = Surroundings(drive_span=110.0)
    assert OffCentreRipple().slight(np.array([2.0, period, 0.0, off]), around) == slight

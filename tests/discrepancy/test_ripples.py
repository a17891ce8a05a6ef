"""Ripples of teeth and wheels that run out of true, in an explanation."""

import pytest

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

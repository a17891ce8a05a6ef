"""Ripples that are no plain wave, against what makes them."""

import numpy as np

from pipeline.physics.motion import Motion
from pipeline.physics.transmission_ripple import TransmissionRipple

DRIVE = np.linspace(-50.0, 50.0, 101)
MOTION = Motion(DRIVE, np.arange(101.0), np.zeros(101, dtype=int))


def ripple(form: str, *values: float) -> np.ndarray:
    return TransmissionRipple(form).respond(DRIVE, MOTION, np.array(values), None)[0] - DRIVE


def test_teeth_that_run_out_of_true_swell_and_fade():
    size = 0.5 * (1.0 + 0.6 * np.sin(2.0 * np.pi * DRIVE / 70.0 + 1.1))
    teeth = np.sin(2.0 * np.pi * DRIVE / 9.0 + 0.3)
    swelling = ripple("swelling afloat", 0.5, 9.0, 0.3, 0.6, 70.0, 1.1)
    np.testing.assert_allclose(swelling, size * teeth, atol=1e-9)


def test_a_wheel_off_its_centre_runs_ahead_by_an_arc_tangent():
    turn = 2.0 * np.pi * DRIVE / 30.0 + 0.3
    for e in (-0.5, 0.2, 0.9):
        off_centre = 0.8 / e * np.arctan2(e * np.sin(turn), 1.0 - e * np.cos(turn))
        np.testing.assert_allclose(
            ripple("eccentric afloat", 0.8, 30.0, 0.3, e), off_centre, atol=1e-9
        )


def test_what_swells_is_resized_alone_and_turned_round_where_that_is_negative():
    values = np.array([0.5, 9.0, 0.3, 0.4, 70.0, 1.1])
    smaller = TransmissionRipple("swelling afloat").resized(values, -0.5)
    np.testing.assert_allclose(smaller, [0.5, 9.0, 0.3, 0.2, 70.0, 1.1 + np.pi])

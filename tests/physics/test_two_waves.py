"""Two waves over the shaft, each of a period of its own."""

import numpy as np

from pipeline.physics.motion import Motion
from pipeline.physics.term import Surroundings
from pipeline.physics.two_ripples import TwoRipples

DRIVE = np.linspace(-50.0, 50.0, 101)
MOTION = Motion(DRIVE, np.arange(101.0), np.zeros(101, dtype=int))
TWO = TwoRipples()


def test_two_waves_add_up():
    values = np.array([2.0, 37.0, 1.1, 0.7, 9.3, 4.0])
    out = TWO.respond(DRIVE, MOTION, values, None)[0]
    first = 2.0 * np.sin(2.0 * np.pi * DRIVE / 37.0 + 1.1)
    other = 0.7 * np.sin(2.0 * np.pi * DRIVE / 9.3 + 4.0)
    np.testing.assert_allclose(out - DRIVE, first + other, atol=1e-9)


def test_two_waves_that_hardly_fall_out_of_step_and_one_that_hardly_comes_again_are_no_two():
    around = Surroundings(drive_span=100.0)
    for period, slight in ((8.9, True), (8.5, False), (37.0, True), (70.0, True)):
        values = np.array([2.0, 9.3 if period < 30.0 else 30.0, 1.1, 0.7, period, 4.0])
        assert TWO.slight(values, around) == slight


def test_the_other_wave_is_resized_alone_and_turned_round_where_that_is_negative():
    values = np.array([2.0, 37.0, 1.1, 0.7, 9.3, 4.0])
    expected = [2.0, 37.0, 1.1, 0.35, 9.3, 4.0 + np.pi]
    np.testing.assert_allclose(TWO.resized(values, -0.5), expected)

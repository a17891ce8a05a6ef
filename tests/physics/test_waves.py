"""Ripples that are no plain wave, against what makes them."""

import numpy as np

from pipeline.physics.catalogue import instead
from pipeline.physics.motion import Motion
from pipeline.physics.off_centre_ripple import OffCentreRipple
from pipeline.physics.swelling_ripple import SwellingRipple
from pipeline.physics.term import Surroundings
from pipeline.physics.transmission_ripple import TransmissionRipple
from pipeline.physics.two_ripples import TwoRipples

DRIVE = np.linspace(-50.0, 50.0, 101)
MOTION = Motion(DRIVE, np.arange(101.0), np.zeros(101, dtype=int))


def ripple(term: TransmissionRipple, *values: float) -> np.ndarray:
    return term.respond(DRIVE, MOTION, np.array(values), None)[0] - DRIVE


def test_teeth_that_run_out_of_true_swell_and_fade():
    size = 0.5 * (1.0 + 0.6 * np.sin(2.0 * np.pi * DRIVE / 70.0 + 1.1))
    teeth = np.sin(2.0 * np.pi * DRIVE / 9.0 + 0.3)
    swelling = ripple(SwellingRipple(), 0.5, 9.0, 0.3, 0.6, 70.0, 1.1)
    np.testing.assert_allclose(swelling, size * teeth, atol=1e-9)


def test_a_wheel_off_its_centre_runs_ahead_by_an_arc_tangent():
    turn = 2.0 * np.pi * DRIVE / 30.0 + 0.3
    for e in (-0.5, 0.2, 0.9):
        off_centre = 0.8 / e * np.arctan2(e * np.sin(turn), 1.0 - e * np.cos(turn))
        np.testing.assert_allclose(
            ripple(OffCentreRipple(), 0.8, 30.0, 0.3, e), off_centre, atol=1e-9
        )


def test_what_swells_is_resized_alone_and_turned_round_where_that_is_negative():
    values = np.array([0.5, 9.0, 0.3, 0.4, 70.0, 1.1])
    smaller = SwellingRipple().resized(values, -0.5)
    np.testing.assert_allclose(smaller, [0.5, 9.0, 0.3, 0.2, 70.0, 1.1 + np.pi])


def test_a_wheel_off_its_centre_is_begun_again_as_teeth_with_its_harmonics():
    wheel = OffCentreRipple()
    for e in (-0.3, 0.3):
        values = np.array([0.8, 30.0, 0.3, e])
        [[(teeth, told)]] = wheel.instead(values, MOTION, Surroundings())
        off = ripple(teeth, *told) - ripple(wheel, *values)
        assert np.abs(off).max() < 0.8 * abs(e) ** 3 / (1.0 - abs(e))


def test_a_ripple_of_hardly_more_than_a_wave_may_be_a_bend_instead():
    around = Surroundings(drive_span=100.0, drive_low=-50.0)
    ripple, size = TransmissionRipple(), np.array([0.5, 70.0, 0.1])
    told = instead(ripple, size, MOTION, around)
    assert {(t.name, t.form) for ((t, _),) in told} == {
        ("compliance", "progressive"),
        ("lens_distortion", "second"),
    }
    assert not instead(ripple, np.array([0.5, 50.0, 0.1]), MOTION, around)


def test_a_wave_as_long_as_the_stairs_of_a_drive_is_what_it_meets_in_passing():
    def over(drive: np.ndarray) -> Motion:
        return Motion(drive, np.arange(len(drive)) * 0.1, np.zeros(len(drive), dtype=int))

    stairs = over(np.repeat([0.0, 2.0, 4.0, 6.0, 4.0, 0.0, -2.0], 5))
    assert stairs.stair == 2.0
    others = [np.arange(30.0), np.repeat([0.0, 2.0, 4.3, 6.0, 3.0], 5)]
    assert all(over(drive).stair == 0.0 for drive in others)
    ripple, two = TransmissionRipple(), TwoRipples()
    for period, met in ((2.01, True), (1.0, True), (2.2, False), (4.0, False), (0.11, False)):
        loud, soft = [0.3, period, 0.1], [0.01, 5.1, 0.2]
        told = [(ripple, loud), (two, [*loud, *soft]), (two, [*soft, *loud])]
        for term, values in told:
            assert (term.chance(np.array(values), stairs) > 0.0) == met
            assert term.chance(np.array(values), over(others[0])) == 0.0

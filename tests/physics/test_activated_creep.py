"""Creep that stress helps, against its equation integrated by another's solver."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from pipeline.physics.activated_creep import ActivatedCreep
from pipeline.physics.creep import Creep
from pipeline.physics.motion import Motion

TIME_S = np.cumsum(np.tile([2.0, 0.5, 7.0, 3.0], 15))
DRIVE = 20.0 * np.sin(TIME_S / 25.0)
MOTION = Motion(DRIVE, TIME_S, np.zeros(len(TIME_S), dtype=int))


@pytest.mark.parametrize("activation", [1.0, 4.0])
def test_what_is_late_flows_as_the_hyperbolic_sine_of_it(activation):
    share, late_s = 0.3, 12.0
    out = ActivatedCreep().respond(DRIVE, MOTION, np.array([share, late_s, activation]), None)[0]
    at, expected = DRIVE[0], [DRIVE[0]]
    for held, dwell_s in zip(DRIVE[1:], np.diff(TIME_S), strict=True):

        def speed(_, x, held=held):
            return activation / late_s * np.sinh((held - x) / activation)

        at = solve_ivp(speed, (0.0, dwell_s), [at], "LSODA", rtol=1e-9, atol=1e-10).y[0, -1]
        expected.append(held + share * (at - held))
    np.testing.assert_allclose(out, expected, atol=1e-6)


def test_what_needs_no_stress_is_creep_of_one_time():
    plain = Creep("whole").respond(DRIVE, MOTION, np.array([0.3, 12.0]), None)[0]
    out = ActivatedCreep().respond(DRIVE, MOTION, np.array([0.3, 12.0, 1e4]), None)[0]
    np.testing.assert_allclose(out, plain, atol=1e-5)


def test_a_step_far_beyond_the_activation_is_followed_at_once_but_for_the_last_of_it():
    far = np.where(TIME_S[3] < TIME_S, 5000.0, 0.0)
    late = far - ActivatedCreep().respond(far, MOTION, np.array([1.0, 50.0, 2.0]), None)[0]
    assert np.all(np.isfinite(late))
    assert 0.0 < late[4] < 20.0


def test_no_time_at_all_leaves_no_infinite_rest():
    far, at_once = np.array([0.0, 5000.0, 5000.0]), np.array([0.0, 1e-30, 4.0])
    motion = Motion(far, at_once, np.zeros(3, dtype=int))
    late = ActivatedCreep().respond(far, motion, np.array([1.0, 50.0, 2.0]), None)[0]
    assert np.all(np.isfinite(late))


def test_it_goes_on_from_the_block_before():
    values = np.array([0.3, 12.0, 2.0])
    whole, last = ActivatedCreep().respond(DRIVE, MOTION, values, None)
    first, state = ActivatedCreep().respond(DRIVE[:20], MOTION.rows(slice(20)), values, None)
    rest, end = ActivatedCreep().respond(DRIVE[20:], MOTION.rows(slice(20, None)), values, state)
    np.testing.assert_allclose(np.concatenate([first, rest]), whole, atol=1e-12)
    np.testing.assert_allclose(end, last)

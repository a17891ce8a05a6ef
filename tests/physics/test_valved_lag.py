"""A lag that is longer one way than the other."""

import numpy as np
from scipy.integrate import solve_ivp

from pipeline.physics.motion import Motion
from pipeline.physics.response_lag import ResponseLag
from pipeline.physics.valved_lag import ValvedLag
from tests.discrepancy.made import explained, recorded

DRIVE = 20.0 * np.sin(np.arange(40) / 4.0)
TIME_S = 3.0 * np.arange(40) + np.random.default_rng(1).uniform(-0.5, 0.5, 40)
MOTION = Motion(DRIVE, TIME_S, np.zeros(40, dtype=int))
VALVED = ValvedLag()


def test_it_follows_its_equation():
    x, expected = DRIVE[0], [DRIVE[0]]
    for u, dwell in zip(DRIVE[1:], np.diff(TIME_S), strict=True):
        found = solve_ivp(
            lambda _, y, u=u: (u - y) / np.where(u > y, 2.0, 5.0), (0.0, dwell), [x], rtol=1e-9
        )
        x = found.y[0, -1]
        expected.append(x)
    out = VALVED.respond(DRIVE, MOTION, np.array([2.0, 2.5]), None)[0]
    np.testing.assert_allclose(out, expected, atol=1e-6)


def test_with_one_time_constant_it_is_the_lag_of_first_order():
    out = VALVED.respond(DRIVE, MOTION, np.array([2.0, 1.0]), None)[0]
    whole = ResponseLag("whole").respond(DRIVE, MOTION, np.array([2.0]), None)[0]
    np.testing.assert_allclose(out, whole, atol=1e-9)


def test_a_damper_with_a_valve_is_named_alone():
    hidden = {"response_lag/valved": {"time_constant": 6.0, "ratio": 2.0}}
    (piece,) = explained(recorded(hidden, cycles=9)).choices[0].fit.pieces
    assert (piece.term.name, piece.term.form) == ("response_lag", "valved")
    np.testing.assert_allclose(piece.values, [6.0, 2.0], rtol=0.1)

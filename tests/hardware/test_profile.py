"""Trapezoids against the kinematics that a pencil gives."""

import numpy as np
import pytest

from pipeline.hardware.profile import braking, resting, then, trapezoid


def test_long_way_cruises() -> None:
    way = trapezoid(100.0, 1100.0, 100.0, 50.0, 100.0)
    assert way.duration_s == pytest.approx(2.0 + (1000.0 - 100.0 - 50.0) / 100.0 + 1.0)
    assert way.at(2.0) == pytest.approx((200.0, 100.0))
    assert way.at(5.0) == pytest.approx((500.0, 100.0))
    assert way.at(way.duration_s + 1.0) == (1100.0, 0.0)


def test_short_way_is_a_triangle() -> None:
    way = trapezoid(0.0, -8.0, 1000.0, 2.0, 2.0)
    assert way.duration_s == pytest.approx(4.0)
    assert way.at(2.0) == pytest.approx((-4.0, -4.0))


@pytest.mark.parametrize("target", [-5000.0, -3.0, 0.5, 218.0, 9999.0])
def test_position_is_the_integral_of_velocity_and_never_jumps(target: float) -> None:
    way = trapezoid(0.0, target, 700.0, 3000.0, 1500.0)
    times = np.linspace(0.0, way.duration_s, 20001)
    position, velocity = np.array([way.at(t) for t in times]).T
    travelled = np.concatenate([[0.0], np.cumsum((velocity[1:] + velocity[:-1]) / 2)]) * times[1]
    assert np.abs(travelled - position).max() < 1e-3 * abs(target)
    assert position[-1] == pytest.approx(target)
    assert np.abs(velocity).max() <= 700.0 + 1e-9


def test_braking_takes_half_v_squared_over_a() -> None:
    stop = braking(10.0, -20.0, 4.0)
    assert stop.rest_qc == pytest.approx(10.0 - 20.0**2 / 8.0)
    assert stop.duration_s == pytest.approx(5.0)
    assert stop.at(-0.5) == pytest.approx((20.0, -20.0))


def test_nothing_to_do_takes_no_time() -> None:
    assert trapezoid(7.0, 7.0, 1.0, 1.0, 1.0) == resting(7.0) == braking(7.0, 0.0, 1.0)


def test_profiles_follow_one_another() -> None:
    first, second = trapezoid(0.0, 4.0, 10.0, 4.0, 4.0), trapezoid(4.0, 0.0, 10.0, 4.0, 4.0)
    both = then(first, second)
    assert both.at(first.duration_s + 0.3) == pytest.approx(second.at(0.3))
    assert both.at(9.0) == (0.0, 0.0)

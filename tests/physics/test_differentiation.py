"""Differentiation: the error bounds that it states, its cut-off, uneven samples, the ends."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from pipeline.physics.differentiation import cutoff_of, differentiate
from pipeline.physics.force_motion import speed_beside
from pipeline.recording import Channel, Recording, with_context

RATE = 1000.0
TIME = np.arange(5000) / RATE
F1, F2 = 1.3, 6.1


def motion(t):
    """Two sines: position, velocity, acceleration [m, m/s, m/s^2]."""
    w1, w2 = 2 * np.pi * F1, 2 * np.pi * F2
    x = 0.1 * np.sin(w1 * t) + 0.02 * np.cos(w2 * t)
    v = 0.1 * w1 * np.cos(w1 * t) - 0.02 * w2 * np.sin(w2 * t)
    a = -0.1 * w1**2 * np.sin(w1 * t) - 0.02 * w2**2 * np.cos(w2 * t)
    return x, v, a


def rms(values):
    return float(np.sqrt(np.mean(values**2)))


def test_differences_of_a_clean_motion_err_by_no_more_than_stated():
    x, v, a = motion(TIME)
    found = differentiate(TIME, x, np.inf)
    turn = (2 * np.pi * F2 / RATE) ** 2
    inside = slice(2, -2)
    assert np.max(np.abs(found.velocity - v)[inside]) < turn / 6 * np.max(np.abs(v))
    assert np.max(np.abs(found.acceleration - a)[inside]) < turn / 12 * np.max(np.abs(a))
    assert not found.resampled


def test_the_low_pass_delays_nothing_and_errs_by_no_more_than_stated():
    x, v, a = motion(TIME)
    found = differentiate(TIME, x, 30.0)
    share = 1.0 - 1.0 / (1.0 + (F2 / 30.0) ** 8) + (2 * np.pi * F2 / RATE) ** 2
    inside = slice(int(3 * RATE / 30.0), -int(3 * RATE / 30.0))
    assert np.max(np.abs(found.velocity - v)[inside]) < share * np.max(np.abs(v))
    assert np.max(np.abs(found.acceleration - a)[inside]) < share * np.max(np.abs(a))
    assert np.max(np.abs(found.velocity - v)[found.known]) < 0.005 * np.max(np.abs(v))
    assert np.sum(~found.known) == pytest.approx(2 * RATE / 30.0, abs=2)


@pytest.mark.parametrize("quantum", [1e-6, 1e-5])
def test_an_encoder_that_counts_in_steps_finds_its_own_cut_off(quantum):
    x, v, a = motion(TIME)
    counted = np.round(x / quantum) * quantum
    found = differentiate(TIME, counted)
    assert 2.0 * F2 < found.cutoff_hz < 0.25 * RATE
    assert rms((found.velocity - v)[found.known]) < 0.01 * rms(v)
    assert rms((found.acceleration - a)[found.known]) < 0.05 * rms(a)
    raw = differentiate(TIME, counted, np.inf)
    assert rms((raw.acceleration - a)[found.known]) > 5 * rms((found.acceleration - a)[found.known])


def test_what_has_no_noise_is_not_filtered():
    slow = np.arange(400) / 50.0
    assert cutoff_of(np.sin(slow[:50]), np.diff(slow[:50], 2), 50.0) == 50.0
    assert differentiate(slow, np.sin(2 * np.pi * 0.25 * slow)).cutoff_hz > 20.0


def test_a_velocity_that_is_known_is_not_rounded_where_it_turns():
    coarse = np.arange(600) / 60.0
    speed = 0.2 * np.arcsin(np.sin(2 * np.pi * 3.1 * coarse))
    way = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1])) / 60.0])
    told = differentiate(coarse, way, np.inf, speed)
    np.testing.assert_array_equal(told.velocity, speed)
    assert told.of_speed
    rounded = differentiate(coarse, way, np.inf)
    assert rms((rounded.velocity - speed)[told.known]) > 0.02 * rms(speed)


def test_a_velocity_is_a_positions_own_only_if_it_goes_as_that_does():
    x, v, _ = motion(TIME)
    names = {"x_m": (x, "m"), "v_m_s": (v, "m/s"), "other_mm_s": (np.roll(v, 400), "mm/s")}
    channels = tuple(Channel(name, "command", unit) for name, (_, unit) in names.items())
    table = pd.DataFrame({"time_s": TIME, **{name: values for name, (values, _) in names.items()}})
    recording = Recording(with_context(table, channels), channels, "simulated")
    np.testing.assert_array_equal(speed_beside(recording, "x_m", x), v)
    alone = replace(recording, channels=(channels[0], channels[2]))
    assert speed_beside(alone, "x_m", x) is None


def test_uneven_samples_and_missing_rows_go_by_an_even_grid():
    rng = np.random.default_rng(3)
    t = np.sort(np.delete(TIME + rng.uniform(-3e-4, 3e-4, len(TIME)), np.arange(2000, 2010)))
    x, v, a = motion(t)
    found = differentiate(t, x, 100.0)
    assert found.resampled
    assert rms((found.velocity - v)[found.known]) < 0.002 * rms(v)
    assert rms((found.acceleration - a)[found.known]) < 0.02 * rms(a)


def test_both_sides_of_a_hole_are_ends():
    t = np.delete(TIME, np.arange(2000, 2600))
    x, v, a = motion(t)
    found = differentiate(t, x)
    assert rms((found.velocity - v)[found.known]) < 0.01 * rms(v)
    assert rms((found.acceleration - a)[found.known]) < 0.05 * rms(a)
    assert not found.known[1999:2001].any()
    assert found.known.sum() > 0.9 * len(t)


def test_times_that_stand_still_are_refused():
    with pytest.raises(ValueError, match="rising times"):
        differentiate(np.array([0.0, 1.0, 1.0, 2.0]), np.zeros(4))

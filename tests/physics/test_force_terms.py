"""Terms of force against motion: analytic answers, memory, units, words."""

from dataclasses import replace

import numpy as np
import pytest

from pipeline.physics.catalogue import (
    LATE,
    LATE_DAMPER,
    PRESSED,
    SPRUNG,
    force_terms,
    further_force_terms,
    richer,
    term,
)
from pipeline.physics.differentiation import differentiate
from pipeline.physics.inertia import Inertia
from pipeline.physics.mechanism import Mechanism
from pipeline.physics.motion import Kinetics, Motion, turned_between
from pipeline.physics.piece import Piece
from pipeline.physics.term import Surroundings, TermError, values_of

AROUND = Surroundings(
    drive_span=0.2, drive_low=-0.1, angle_span=100.0, angle_low=-50.0, dwell_s=1e-3, start_s=0.0,
    end_s=4.0, cycles=4, drive_unit="m", angle_unit="N", top_speed=0.6, top_acceleration=4.0,
)  # fmt: skip
EVERY = (*force_terms(), *further_force_terms())
OWN = [t for first in EVERY for t in (first, *richer(first)) if t.site == "body" and t.adds]
OWN += (SPRUNG, LATE_DAMPER, *LATE, *PRESSED)


def swing(amplitude=0.1, seconds=4.0):
    t = np.arange(int(seconds * 1000)) / 1000.0
    w = 2 * np.pi
    x = amplitude * np.sin(w * t)
    kinetics = Kinetics(amplitude * w * np.cos(w * t), -w * w * x, np.full(len(t), 3.0))
    return Motion(x, t, (t // 1.0).astype(int), radian=1.0, kinetics=kinetics)


def answer(name, form, values, motion):
    return Mechanism(pieces=(Piece(term(name, form), np.array(values)),)).respond(motion)[0] - 3.0


def test_forces_are_what_their_equations_say():
    m = swing()
    v, a = m.kinetics.velocity, m.kinetics.acceleration
    np.testing.assert_allclose(answer("inertia", "", [2.0], m), 2.0 * a, atol=1e-12)
    np.testing.assert_allclose(answer("stiffness", "", [7.0], m), 7.0 * m.drive, atol=1e-12)
    np.testing.assert_allclose(
        answer("stiffness", "hardening", [7.0, 5.0], m),
        7.0 * (m.drive + 5.0 * m.drive**3),
        atol=1e-12,
    )
    both = np.where(v > 0, 3.0 * 1.2, 3.0 * 0.8)
    np.testing.assert_allclose(
        answer("viscous_friction", "asymmetric", [3.0, 0.2], m), both * v, atol=1e-12
    )
    np.testing.assert_allclose(
        answer("viscous_friction", "square", [3.0, 4.0], m), (3.0 + 4.0 * np.abs(v)) * v, atol=1e-12
    )
    np.testing.assert_allclose(
        answer("viscous_friction", "power", [3.0, 0.5], m), 3.0 * np.sign(v) * np.sqrt(np.abs(v))
    )
    np.testing.assert_allclose(
        answer("stribeck_friction", "smoothed tustin", [9.0, 0.2, 0.01], m),
        9.0 * np.tanh(v / 0.01) * np.exp(-np.abs(v) / 0.2),
        atol=1e-12,
    )
    np.testing.assert_allclose(
        answer("stiffness", "gas", [7.0, -4.0], m),
        7.0 * (1.0 - (1.0 + 4.0 * m.drive) ** -1.3) / (4.0 * 1.3),
        atol=1e-12,
    )
    slack = answer("slack", "force aside", [7.0, 0.04, 0.02], m)
    np.testing.assert_allclose(slack, -7.0 * np.clip(m.drive, 0.0, 0.04), atol=1e-12)
    lower = answer("contact", "lower buffer", [7.0, -0.06, 1e-6], m)
    np.testing.assert_allclose(lower, 7.0 * np.minimum(m.drive + 0.06, 0.0), atol=1e-5)
    np.testing.assert_allclose(
        answer("gravity", "force", [5.0, 0.3], replace(m, radian=0.02)),
        5.0 * np.sin(m.drive / 0.02 + 0.3),
        atol=1e-12,
    )
    np.testing.assert_allclose(
        answer("transmission_ripple", "force", [5.0, 0.03, 0.3], m),
        5.0 * np.sin(2.0 * np.pi * m.drive / 0.03 + 0.3),
        atol=1e-12,
    )


def test_a_ripple_has_a_second_wave_that_turns_with_the_first():
    m = swing()
    turned = 2.0 * np.pi * m.drive / 0.03 + 0.3
    both = 5.0 * np.sin(turned) + 2.0 * np.sin(2.0 * turned + 0.7)
    values = [5.0, 0.03, 2.0, 0.7, 0.3]
    np.testing.assert_allclose(
        answer("transmission_ripple", "force second", values, m), both, atol=1e-12
    )
    less = term("transmission_ripple", "force second").scaled(np.array(values), -0.5)
    np.testing.assert_allclose(
        answer("transmission_ripple", "force second", less, m), -0.5 * both, atol=1e-12
    )


def test_a_force_that_swings_is_late_by_the_phase_of_second_order():
    m = swing()
    w, own, damping = 2.0 * np.pi, 9.0, 0.4
    pieces = [Piece(LATE[1], np.array([own, damping])), Piece(term("stiffness"), np.array([7.0]))]
    force = Mechanism(pieces=pieces).respond(m)[0] - 3.0
    answered = own**2 / (own**2 - w**2 + 2j * damping * own * w)
    expected = 0.7 * np.imag(answered * np.exp(1j * w * m.time_s))
    np.testing.assert_allclose(force[3500:], expected[3500:], atol=2e-3)


@pytest.mark.parametrize("time_constant_s", [0.003, 0.2])
def test_a_force_behind_a_lag_follows_a_sine_late(time_constant_s):
    m = swing()
    pieces = [
        Piece(LATE[0], np.array([time_constant_s])),
        Piece(term("stiffness"), np.array([7.0])),
    ]
    force = Mechanism(pieces=pieces).respond(m)[0] - 3.0
    lag = np.arctan(2.0 * np.pi * time_constant_s)
    expected = 0.7 * np.cos(lag) * np.sin(2.0 * np.pi * m.time_s - lag)
    np.testing.assert_allclose(force[2000:], expected[2000:], atol=1e-4)


@pytest.mark.parametrize("relaxation_s", [0.003, 0.2])
def test_a_damper_behind_a_spring_follows_a_sine_as_maxwell_says(relaxation_s):
    m = swing()
    force = answer("viscous_friction", "sprung", [3.0, relaxation_s, 0.0], m)
    w = 2.0 * np.pi
    lag = np.arctan(w * relaxation_s)
    expected = 0.3 * w * np.cos(lag) * np.cos(w * m.time_s - lag)
    np.testing.assert_allclose(force[2000:], expected[2000:], atol=5e-3 * 0.3 * w)


def test_a_damper_lets_go_of_its_spring_within_half_a_cycle_and_a_late_one_is_no_less_than_none():
    relaxation = {p.name: p for p in SPRUNG.parameters(AROUND)}["relaxation"]
    assert relaxation.high == pytest.approx(0.5)
    resisting = replace(AROUND, resisting=True)
    assert SPRUNG.parameters(resisting)[0].low < 0.0
    late = LATE_DAMPER.parameters(resisting)[0]
    assert (late.name, late.low) == ("damping", 0.0)
    assert late.start >= 0.0


def test_a_damper_that_was_already_moved_lets_go_of_what_its_spring_holds():
    m = swing()
    at_rest, moved = (answer("viscous_friction", "sprung", [3.0, 0.2, b], m) for b in (0.0, 0.5))
    gone = 3.0 * 0.5 * np.exp(-(m.time_s - m.time_s[0]) / 0.2)
    np.testing.assert_allclose(moved - at_rest, gone, atol=1e-9)


def test_a_late_damper_lacks_what_the_same_one_behind_a_spring_does_not_resist():
    m = swing()
    late = answer("response_lag", "damper", [3.0, 0.2, 0.4], m)
    sprung = answer("viscous_friction", "sprung", [3.0, 0.2, 0.4], m)
    np.testing.assert_allclose(late, sprung - 3.0 * m.kinetics.velocity, atol=1e-9)
    assert not LATE_DAMPER.excited(m, AROUND)
    assert LATE_DAMPER.excited(m, replace(AROUND, resisting=True))


def test_dry_friction_slides_at_its_force_and_turns_round_within_its_reach():
    m = swing()
    force = answer("coulomb_friction", "asymmetric", [10.0, 0.001, 0.2], m)
    sliding = (np.abs(m.kinetics.velocity) > 0.3) & (np.arange(len(m)) > 50)
    expected = np.where(m.kinetics.velocity > 0, 12.0, -8.0)
    np.testing.assert_allclose(force[sliding], expected[sliding], atol=1e-6)
    one_slider = answer("coulomb_friction", "spread", [10.0, 0.02, 0.0], m)
    top = int(np.argmax(m.drive))
    back = m.drive[top] - m.drive[top : top + 200]
    np.testing.assert_allclose(
        one_slider[top : top + 200], np.maximum(10.0 - 10.0 * back / 0.02, -10.0), atol=1e-9
    )

    for release in (1.0, 0.0):
        bristle = answer("coulomb_friction", "bristle", [10.0, 0.02, release], m)[top : top + 200]
        dahl = -10.0 + 20.0 * np.exp(-back / 0.02)
        spring = np.where(back < 0.02, 10.0 - 500.0 * back, 10.0 * (np.exp(1 - back / 0.02) - 1.0))
        np.testing.assert_allclose(bristle, dahl if release else spring, atol=0.2)


def test_dry_friction_remembers_small_loops():
    """A small loop inside the pre-sliding travel closes on itself (return-point memory)."""
    corners = [0.0, 0.1, 0.095, 0.1, 0.12]
    counts = [100, 19, 19, 19]
    steps = np.concatenate(
        [[0.0]] + [a + (b - a) * np.arange(1, n + 1) / n
                   for a, b, n in zip(corners, corners[1:], counts, strict=False)]
    )  # fmt: skip
    still = np.zeros(len(steps))
    t = np.arange(len(steps), dtype=float)
    m = Motion(steps, t, np.zeros(len(t), dtype=int), kinetics=Kinetics(still, still, still))
    friction = Piece(term("coulomb_friction"), np.array([10.0, 0.01]))
    force = Mechanism(pieces=(friction,)).respond(m)[0]
    assert force[100 + 38] == pytest.approx(force[100], abs=1e-9)
    assert force[100 + 19] < force[100] - 1.0


def test_smoothed_friction_knows_the_speed_alone():
    m = swing()
    v = m.kinetics.velocity
    np.testing.assert_allclose(
        answer("coulomb_friction", "smoothed", [10.0, 0.02], m),
        10.0 * np.tanh(v / 0.02),
        atol=1e-9,
    )
    both = np.where(v > 0, 12.0, 8.0) * np.tanh(v / 0.02)
    np.testing.assert_allclose(
        answer("coulomb_friction", "smoothed asymmetric", [10.0, 0.02, 0.2], m), both, atol=1e-9
    )
    np.testing.assert_allclose(
        answer("stribeck_friction", "smoothed", [4.0, 0.1, 0.02], m),
        4.0 * np.tanh(v / 0.02) * np.exp(-((v / 0.1) ** 2)),
        atol=1e-9,
    )


def test_friction_behind_a_spring_slides_as_its_slip_law_says():
    """F = force tanh(slip / onset), the spring's stretch and the slip together the motion."""
    m = swing()
    onset, reach, step_s = 0.05, 0.01, 1e-3 / 50
    share, held = 0.0, np.zeros(len(m))
    for k in range(1, len(m)):
        for part in (np.arange(50) + 0.5) / 50:
            v = m.kinetics.velocity[k - 1] * (1.0 - part) + m.kinetics.velocity[k] * part
            share += (
                (v - onset * np.arctanh(min(max(share, -1 + 1e-12), 1 - 1e-12))) * step_s / reach
            )
        held[k] = share
    told = answer("coulomb_friction", "smoothed sprung", [10.0, onset, reach], m)
    np.testing.assert_allclose(told, 10.0 * held, atol=0.1)
    stiff = answer("coulomb_friction", "smoothed sprung", [10.0, onset, 1e-6], m)
    plain = 10.0 * np.tanh(m.kinetics.velocity / onset)
    np.testing.assert_allclose(stiff[1:], plain[1:], atol=0.1)


def test_a_bristle_behind_a_dashpot_gives_way_as_spencers_damper_does():
    """z' = (x' - onset z)(1 - z^2 where z grows) / reach; slow motion is the dashpot's alone."""
    m = swing()
    onset, reach, step_s = 0.2, 0.01, 1e-3 / 50
    share, held = 0.0, np.zeros(len(m))
    for k in range(1, len(m)):
        for part in (np.arange(50) + 0.5) / 50:
            v = m.kinetics.velocity[k - 1] * (1.0 - part) + m.kinetics.velocity[k] * part
            bend = v - onset * share
            share += bend * (1.0 - share**2 if bend * share > 0.0 else 1.0) * step_s / reach
        held[k] = share
    told = answer("coulomb_friction", "smoothed dashpot", [10.0, onset, reach], m)
    np.testing.assert_allclose(told, 10.0 * held, atol=0.1)
    stiff = answer("coulomb_friction", "smoothed dashpot", [10.0, onset, 1e-6], m)
    clipped = 10.0 * np.clip(m.kinetics.velocity / onset, -1.0, 1.0)
    np.testing.assert_allclose(stiff[1:], clipped[1:], atol=0.1)


@pytest.mark.parametrize("release", [0.6, 2.5])
@pytest.mark.parametrize("curve", [0.4, 1.0, 3.0])
def test_a_bent_bristle_gives_way_by_its_exponent(curve, release):
    m, reach = swing(), 0.02
    share, held = 0.0, np.zeros(len(m))
    for k in range(1, len(m)):
        for _ in range(50):
            dx = (m.drive[k] - m.drive[k - 1]) / 50
            own = np.sign(dx) * share
            if own >= 0.0:
                rate = 1.0 - own**curve if curve > 1.0 else (1.0 - own) ** (1.0 / curve)
            else:
                power = (1.0, curve) if curve > 1.0 else (1.0 / curve, 1.0)
                rate = (1.0 + release * (-own) ** power[1]) ** power[0]
            share += dx / reach * rate
        held[k] = share
    told = answer("coulomb_friction", "bristle bent", [10.0, reach, release, curve], m)
    np.testing.assert_allclose(told, 10.0 * held, atol=0.15)


def test_a_wedge_presses_the_contact_by_the_way():
    m = swing()
    plain = answer("coulomb_friction", "spread", [1.0, 0.01, 0.5], m)
    told = answer("coulomb_friction", "spread loaded", [10.0, 0.01, 0.5, 40.0, 0.02], m)
    np.testing.assert_allclose(told, (10.0 + 40.0 * np.abs(m.drive - 0.02)) * plain, atol=1e-9)
    eased = answer("coulomb_friction", "loaded", [1.0, 0.01, -40.0, 0.0], m)
    assert np.all(eased[np.abs(m.drive) > 0.03] == 0.0)  # nothing pulls what it holds no more


def test_a_turn_between_two_samples_is_remembered():
    t = np.arange(200) / 40.0
    x, v = np.sin(2 * np.pi * t + 0.39), 2 * np.pi * np.cos(2 * np.pi * t + 0.39)
    turned = turned_between(t, x, v)
    between = turned != x
    assert between.sum() == 10
    np.testing.assert_allclose(np.abs(turned[between]), 1.0, atol=1e-4)
    kinetics = Kinetics(v, -4 * np.pi**2 * x, 0.0 * x, turned)
    cycle = np.zeros(len(t), dtype=int)
    fine_t = np.arange(200 * 50) / 2000.0
    fine = Motion(
        np.sin(2 * np.pi * fine_t + 0.39), fine_t, np.zeros(len(fine_t), dtype=int),
        kinetics=Kinetics(0.0 * fine_t, 0.0 * fine_t, 0.0 * fine_t),
    )  # fmt: skip
    friction = [Piece(term("coulomb_friction", "spread"), np.array([10.0, 0.05, 0.0]))]
    true = Mechanism(pieces=friction).respond(fine)[0][::50]
    told = Mechanism(pieces=friction).respond(Motion(x, t, cycle, kinetics=kinetics))[0]
    bare = replace(kinetics, turned=np.zeros(0), simulated=0.0 * x)
    missed = Mechanism(pieces=friction).respond(Motion(x, t, cycle, kinetics=bare))[0]
    assert np.max(np.abs(told - true)) < 0.1 < 0.4 < np.max(np.abs(missed - true))


def test_stribeck_is_gone_at_speed_and_whole_at_rest():
    m = swing()
    force = answer("stribeck_friction", "", [5.0, 0.05, 1e-5], m)
    v = m.kinetics.velocity
    expected = 5.0 * np.sign(v) * np.exp(-((v / 0.05) ** 2))
    away = np.abs(v) > 0.02
    np.testing.assert_allclose(force[away], expected[away], atol=0.05)
    assert np.max(np.abs(force[np.abs(v) > 0.3])) < 1e-12


def test_stribeck_comes_over_the_bristles_way_as_in_the_lugre_model():
    m = swing(0.02)
    v, step_s, reach, more = m.kinetics.velocity, 1e-3 / 20, 5e-4, 0.05
    held, z = np.zeros(len(m)), 0.0
    for k in range(1, len(m)):
        for part in (np.arange(20) + 0.5) / 20:
            now = v[k - 1] + part * (v[k] - v[k - 1])
            z += (now - abs(now) * z / (1.0 + more * np.exp(-((now / 0.05) ** 2))) / reach) * step_s
        held[k] = z / reach
    told = answer("coulomb_friction", "bristle", [1.0, reach, 1.0], m)
    told += answer("stribeck_friction", "", [more, 0.05, reach], m)
    np.testing.assert_allclose(told, held, atol=0.1 * more)


@pytest.mark.parametrize("physics", OWN, ids=lambda t: f"{t.name}-{t.form}")
def test_every_force_has_bounds_words_a_source_and_memory(physics):
    m = swing()
    values = values_of(physics, AROUND, {})
    assert "{" not in physics.sentence(values, AROUND)
    assert "Source" in type(physics).__doc__
    beside = () if physics.adds else (Piece(term("stiffness"), np.array([7.0])),)
    mechanism = Mechanism(pieces=(Piece(physics, values), *beside))
    whole = mechanism.respond(m)[0]
    assert np.std(whole) > 1e-3
    parts, state = [], None
    for part in (slice(0, 1), slice(1, 1370), slice(1370, None)):
        force, state = mechanism.respond(m.rows(part), state)
        parts.append(force)
    np.testing.assert_allclose(np.concatenate(parts), whole, atol=1e-9)


def test_units_come_from_the_channels():
    units = {t.name: t.parameters(AROUND)[0].unit for t in OWN}
    assert units["inertia"] == "kg"
    assert units["viscous_friction"] == "N s/m"
    turning = replace(AROUND, drive_unit="rad", angle_unit="Nm")
    assert term("inertia").parameters(turning)[0].unit == "kg m^2"
    assert term("stiffness").parameters(replace(AROUND, angle_unit="V"))[0].unit == "V/m"


def test_the_gain_scales_the_simulation_alone():
    m = swing()
    pieces = (Piece(term("viscous_friction"), np.array([3.0])),)
    force = Mechanism(pieces=pieces, gain=2.0, offset=1.0).respond(m)[0]
    np.testing.assert_allclose(force, 2.0 * 3.0 + 1.0 + 3.0 * m.kinetics.velocity, atol=1e-12)


def test_a_force_term_of_an_angle_is_refused():
    m = replace(swing(), kinetics=None)
    with pytest.raises(TermError, match="'inertia': expected a force measured against a position"):
        Mechanism(pieces=(Piece(term("inertia"), np.array([1.0])),)).respond(m)


def test_derivatives_give_back_the_force_that_a_mass_and_a_damper_need():
    m = swing()
    found = differentiate(m.time_s, m.drive)
    force = 5.0 * found.acceleration + 3.0 * found.velocity
    true = 5.0 * m.kinetics.acceleration + 3.0 * m.kinetics.velocity
    assert np.max(np.abs(force - true)[found.known]) < 1e-3 * np.max(np.abs(true))


def test_dry_friction_that_differs_a_little_along_the_way_is_not_told_as_pressed():
    loaded = term("coulomb_friction", "loaded")
    for growth, middle, slight in [(15.0, 0.0, True), (60.0, 0.0, False), (-40.0, 0.1, False)]:
        assert loaded.slight(np.array([10.0, 0.01, growth, middle]), AROUND) == slight
    assert not term("coulomb_friction").slight(np.array([10.0, 0.01]), AROUND)


def test_there_is_too_much_mass_only_where_the_simulation_has_some():
    for accelerating in (False, True):
        around = replace(AROUND, simulated=True, accelerating=accelerating)
        (mass,) = Inertia().parameters(around)
        assert (mass.low < 0.0) == accelerating


@pytest.mark.parametrize("form", [t.form for t in EVERY if t.form.startswith("force of a")])
@pytest.mark.parametrize("size", [1, 37, 400])
def test_what_hangs_on_a_pin_goes_on_from_block_to_block(form: str, size: int):
    """Through reversals within the gap, at its ends and beyond."""
    m = swing(seconds=2.0)
    x = m.drive + 0.03 * np.sin(31.0 * m.time_s)
    resists = 20.0 * np.tanh(np.gradient(x, m.time_s) / 0.05) + 40.0 * x
    m = replace(m, drive=x, kinetics=replace(m.kinetics, simulated=resists))
    mechanism = Mechanism(pieces=[Piece(term("backlash", form), np.array([0.04, 40.0]))])
    whole, parts, state = mechanism.respond(m)[0], [], None
    for first in range(0, len(m), size):
        force, state = mechanism.respond(m.rows(slice(first, first + size)), state)
        parts.append(force)
    np.testing.assert_allclose(np.concatenate(parts), whole, atol=1e-12)
    assert np.ptp(whole - resists) > 20.0


def test_a_round_buffer_is_the_law_of_hertz_where_it_is_pressed():
    """F = k deep (z / deep)^1.5 beyond the position, where its skin is thin."""
    position, deep, stiffness = 10.0, 6.0, 2.0
    drive = np.linspace(0.0, 30.0, 200)
    zero = np.zeros_like(drive)
    kinetics = Kinetics(zero, zero, zero, np.zeros(0, dtype=int))
    motion = Motion(drive, np.arange(200.0), np.zeros(200, dtype=int), kinetics=kinetics)
    values = np.array([stiffness, position, 1e-3, 0.5, deep])
    for name, side in (("upper", 1.0), ("lower", -1.0)):
        force = term("contact", f"{name} round buffer").respond(zero, motion, values, None)[0]
        depth = np.maximum(side * (drive - position), 0.0)
        expected = side * stiffness * deep * (depth / deep) ** 1.5
        np.testing.assert_allclose(force, expected, atol=0.01)


def test_a_damped_buffer_never_pulls():
    drive, away = np.full(5, 16.0), np.array([2.0, 0.0, -1.0, -4.0, -9.0])
    zero = np.zeros(5)
    kinetics = Kinetics(away, zero, zero, np.zeros(0, dtype=int))
    motion = Motion(drive, np.arange(5.0), np.zeros(5, dtype=int), kinetics=kinetics)
    values = np.array([2.0, 10.0, 1e-3, 0.5, 6.0, 0.2])
    force = term("contact", "upper damped buffer").respond(zero, motion, values, None)[0]
    np.testing.assert_allclose(force, 12.0 * np.maximum(1.0 + 0.2 * away, 0.0), atol=0.01)

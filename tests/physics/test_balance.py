"""The balance at the joint against what can be worked out by hand."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.optimize import brentq

from pipeline.physics.backlash import Backlash
from pipeline.physics.contact import Contact
from pipeline.physics.coupling import Coupling
from pipeline.physics.creep import Creep
from pipeline.physics.end_stop import EndStop
from pipeline.physics.friction import Friction
from pipeline.physics.gravity import Gravity
from pipeline.physics.kinematics import CubicCurve, SampledCurve, sampled_curve
from pipeline.physics.mechanism import Mechanism
from pipeline.physics.motion import Motion
from pipeline.physics.piece import Piece
from pipeline.physics.response_lag import LOADED, RUNNING, ResponseLag
from pipeline.physics.second_order_lag import SecondOrderLag
from pipeline.physics.slack import Slack
from pipeline.physics.soft_wire import SoftWire
from pipeline.physics.term import Surroundings
from pipeline.physics.transmission_ripple import TransmissionRipple
from tests.physics.test_terms import triangle


def line(start: float, end: float, n: int, dwell_s: float = 1.0) -> Motion:
    return Motion(np.linspace(start, end, n), dwell_s * np.arange(n), np.zeros(n, dtype=int))


def answer(motion: Motion, *pieces: Piece) -> np.ndarray:
    return Mechanism(pieces=pieces).respond(motion)[0]


def test_backlash_is_the_play_operator():
    motion = Motion(np.array([0.0, 3, 6, 4, 2, -6]), np.arange(6.0), np.zeros(6, dtype=int))
    out = answer(motion, Piece(Backlash(), np.array([4.0])))
    np.testing.assert_allclose(out, [0, 1, 4, 4, 4, -4])


def test_friction_holds_back_by_its_width_once_it_slides():
    motion = triangle(2)
    out = answer(motion, Piece(Friction(), np.array([5.0, 2.0, 0.7])))
    up = out[
        (np.diff(motion.drive, prepend=0) > 0) & (np.abs(motion.drive) < 1) & (motion.cycle > 0)
    ]
    down = out[(np.diff(motion.drive, prepend=0) < 0) & (np.abs(motion.drive) < 1)]
    assert np.mean(down) - np.mean(up) == pytest.approx(5.0, abs=0.05)


def test_stiff_friction_becomes_backlash():
    motion = triangle(2)
    stiff = answer(motion, Piece(Friction(), np.array([4.0, 0.01, 0.0])))
    play = answer(motion, Piece(Backlash(), np.array([4.0])))
    np.testing.assert_allclose(stiff, play, atol=0.02)


def test_a_contact_lowers_the_slope_beyond_its_angle():
    motion = line(0.0, 40.0, 401)
    out = answer(motion, Piece(Contact("upper"), np.array([1.5, 20.0, 0.1])))
    slope = np.diff(out) / np.diff(motion.drive)
    assert slope[50] == pytest.approx(1.0, abs=1e-3)
    assert slope[-1] == pytest.approx(1.0 / 2.5, abs=1e-3)


def test_a_contact_that_unloads_a_wire_doubles_what_gives_way():
    motion = line(0.0, 60.0, 601)
    out = answer(motion, Piece(Contact("upper unloading"), np.array([1.0, 20.0, 0.1, 5.0])))
    slope = np.diff(out) / np.diff(motion.drive)
    assert slope[250] == pytest.approx(1.0 / 2.0, abs=1e-2)
    assert slope[-1] == pytest.approx(1.0 / 3.0, abs=1e-3)


def test_an_end_stop_holds():
    out = answer(line(-60.0, 60.0, 601), Piece(EndStop("lower"), np.array([-30.0, 0.1, 0.01])))
    assert out.min() > -31.0
    assert out[-1] == pytest.approx(60.0, abs=1e-3)


@pytest.mark.parametrize("sliding", [False, True])
def test_a_joint_is_found_as_closely_in_every_unit(sliding):
    size, motion = 2.0**-20, triangle(2)
    small = replace(motion, drive=size * motion.drive, radian=size * motion.radian)
    stop = np.array([20.0, 0.5, 0.004])
    friction = np.array([3.0, 2.0, 0.7])
    rubbing = [Piece(Friction(), friction)] * sliding
    rubbing_small = [Piece(Friction(), friction * [size, size, 1.0])] * sliding
    out = answer(motion, Piece(EndStop("upper"), stop), *rubbing)
    same = answer(small, Piece(EndStop("upper"), stop * [size, size, 1.0]), *rubbing_small)
    np.testing.assert_allclose(same / size, out, atol=1e-9)


def test_slack_stands_still_over_its_width():
    motion = line(-40.0, 40.0, 801)
    out = answer(motion, Piece(Slack(), np.array([8.0, 2.0, 0.02, 0.02])))
    inside = np.abs(motion.drive - 2.0) < 3.5
    assert np.ptp(out[inside]) < 0.5
    assert np.ptp(out) == pytest.approx(72.0, rel=0.05)


def test_slack_is_lost_of_the_drive_before_a_curve_that_bends():
    motion, curve = line(-60.0, 60.0, 1201), CubicCurve(0.8, 2e-5)
    slack = Piece(Slack(), np.array([12.0, 5.0, 0.01, 0.01]))
    out = Mechanism(curve, [slack]).respond(motion)[0]
    lost = np.clip(motion.drive - 5.0, -6.0, 6.0)
    taut = np.abs(motion.drive - 5.0) > 9.0
    middle = float(curve(np.array([5.0]))[0])
    expected = middle + (curve(motion.drive - lost) - middle) / 1.01
    np.testing.assert_allclose(out[taut], expected[taut], atol=0.01)


def test_slack_behind_the_curve_is_lost_of_the_angle_that_is_asked_for():
    motion, curve = line(-60.0, 60.0, 1201), CubicCurve(0.8, 2e-5)
    slack = Piece(Slack("behind"), np.array([12.0, 5.0, 0.01, 0.01]))
    out = Mechanism(curve, [slack]).respond(motion)[0]
    asked, middle = curve(motion.drive), float(curve(np.array([5.0]))[0])
    lost = 6.0 * curve.slope * np.sign(motion.drive - 5.0)
    taut = np.abs(motion.drive - 5.0) > 9.0
    expected = middle + (asked - lost - middle) / 1.01
    np.testing.assert_allclose(out[taut], expected[taut], atol=0.01)


def test_creep_arrives_with_its_share_and_time_constant():
    motion = Motion(np.r_[0.0, np.full(40, 10.0)], 2.0 * np.arange(41), np.zeros(41, dtype=int))
    out = answer(motion, Piece(Creep(), np.array([0.3, 20.0])))
    np.testing.assert_allclose(
        out[1:], 10.0 * (1 - 0.3 * np.exp(-motion.time_s[1:] / 20.0)), rtol=1e-4
    )


def test_gravity_solves_its_own_equation():
    motion = line(-50.0, 50.0, 101)
    out = answer(motion, Piece(Gravity(), np.array([4.0, 0.4])))
    load = 4.0 * (np.sin(np.radians(out) - 0.4) + np.sin(0.4))
    np.testing.assert_allclose(out + load, motion.drive, atol=1e-5)


def test_a_weight_that_sags_bends_its_joint_at_home_as_well():
    motion = line(-50.0, 50.0, 101)
    out = answer(motion, Piece(Gravity("sagging"), np.array([8.0, -1.3])))
    load = 8.0 * np.sin(np.radians(out) + 1.3)
    np.testing.assert_allclose(out + load, motion.drive, atol=1e-5)
    assert abs(out[50]) > 7.0


def test_a_weight_that_unloads_a_wire_doubles_what_gives_way():
    motion = line(-50.0, 50.0, 101)
    out = answer(motion, Piece(Gravity("unloading"), np.array([14.0, 2.1, 5.0])))
    load = 14.0 * (np.sin(np.radians(out) - 2.1) + np.sin(2.1))
    slack = np.sign(load) * np.maximum(np.abs(load) - 5.0, 0.0)
    assert 0 < np.count_nonzero(slack) < len(slack)
    np.testing.assert_allclose(out + load + slack, motion.drive, atol=1e-4)


@pytest.mark.parametrize("deflection", [80.0, 120.0, 160.0])
def test_gravity_that_snaps_over_still_solves_its_equation(deflection):
    drive = 300.0 * np.sin(2 * np.pi * np.linspace(0.0, 3.0, 2000))
    motion = Motion(drive, np.arange(2000.0), np.zeros(2000, dtype=int), radian=180.0 / np.pi)
    for zero in np.linspace(-3.0, 3.0, 13):
        out = answer(motion, Piece(Gravity(), np.array([deflection, zero])))
        load = deflection * (np.sin(np.deg2rad(out) - zero) + np.sin(zero))
        np.testing.assert_allclose(out + load, drive, atol=1e-3 * deflection)


def test_friction_and_stop_meet_in_one_equation():
    pieces = (
        Piece(Friction(), np.array([6.0, 2.0, 0.7])),
        Piece(EndStop("upper"), np.array([30.0, 0.1, 0.01])),
    )
    out = answer(triangle(2), *pieces)
    top = out[60:100]
    assert out.max() < 31.0
    assert np.all(np.diff(top[np.argmax(top) + 8 :]) <= 1e-6)


def test_a_sampled_curve_follows_its_samples_and_goes_on_straight():
    drive = np.linspace(-50, 50, 1001)
    curve = sampled_curve(drive, CubicCurve(0.7, 1e-5)(drive))
    np.testing.assert_allclose(curve(drive), CubicCurve(0.7, 1e-5)(drive), atol=2e-4)
    beyond = curve(np.array([50.0, 51.0, 52.0]))
    assert np.diff(beyond)[0] == pytest.approx(np.diff(beyond)[1])
    assert SampledCurve(0.0, 1.0, np.array([0.0, 2.0])).slope == 2.0


@pytest.mark.parametrize(
    ("late", "other", "within"),
    [
        (Piece(Creep(), np.array([0.2, 9.0])), Piece(Friction(), np.array([5.0, 4, 0.7])), 1e-3),
        (
            Piece(Creep(), np.array([0.2, 9])),
            Piece(SoftWire(), np.array([0.3, 10, 0.1, 1])),
            1e-3,
        ),
        (Piece(Creep(), np.array([0.1, 60])), Piece(Slack(), np.array([12, 0, 0.3, 0.02])), 1e-3),
        (Piece(ResponseLag(), np.array([2.0])), Piece(Friction(), np.array([5.0, 4, 0.7])), 0.05),
        (Piece(ResponseLag(), np.array([4.0])), Piece(Friction(), np.array([2.0, 0.2, 0.0])), 0.01),
        (Piece(ResponseLag(), np.array([4])), Piece(EndStop(), np.array([30, 0.05, 0.02])), 0.03),
        (Piece(ResponseLag(), np.array([4])), Piece(Contact(), np.array([6, 20, 0.4])), 0.03),
    ],
)
def test_a_dwell_taken_at_once_is_many_short_ones(late, other, within):
    parts, drive = 100, triangle(1).drive
    coarse = Motion(drive, 3.0 * np.arange(len(drive)), np.zeros(len(drive), dtype=int))
    held = np.r_[drive[0], np.repeat(drive[1:], parts)]
    fine = Motion(held, 3.0 / parts * np.arange(len(held)), np.zeros(len(held), dtype=int))
    np.testing.assert_allclose(
        answer(coarse, late, other), answer(fine, late, other)[::parts], atol=within
    )


def test_loose_wires_balance_beside_a_lag():
    motion = triangle(2)
    slack = Piece(Slack(), np.array([12.0, 0.0, 0.3, 0.05]))
    out = answer(motion, slack, Piece(ResponseLag(), np.array([2.0])))
    assert np.abs(np.diff(out)).max() < np.abs(np.diff(motion.drive)).max()
    assert np.abs(out - motion.drive).max() < 10.0


def test_slack_of_no_width_leaves_a_lag_and_a_friction_as_they_are():
    motion = triangle(2)
    slack = Piece(Slack("home"), np.array([0.0, 0.01, 1e-6]))
    for other in (Piece(ResponseLag(), np.array([8.0])), Piece(Friction(), np.array([3, 4, 0.5]))):
        np.testing.assert_allclose(answer(motion, slack, other), answer(motion, other), atol=1e-3)


def test_a_lagging_joint_creeps_between_its_loose_wires_over_a_long_dwell():
    drive = np.r_[np.linspace(0.0, 10.0, 20), np.linspace(9.0, 3.0, 7)]
    coarse = Motion(drive, 9.0 * np.arange(len(drive)), np.zeros(len(drive), dtype=int))
    held = np.r_[drive[0], np.repeat(drive[1:], 60)]
    fine = Motion(held, 9.0 / 60 * np.arange(len(held)), np.zeros(len(held), dtype=int))
    slack = Piece(Slack("home"), np.array([4.0, 0.01, 0.02]))
    lag = Piece(ResponseLag(), np.array([4.0]))
    settled = answer(fine, slack, lag)[::60]
    assert settled[-1] > drive[-1] + 1.0
    np.testing.assert_allclose(answer(coarse, slack, lag), settled, atol=0.03)


def test_a_soft_stop_gives():
    motion = line(0.0, 60.0, 601)
    out = answer(motion, Piece(EndStop("upper"), np.array([30.0, 0.01, 0.05])))
    slope = np.diff(out) / np.diff(motion.drive)
    assert slope[-1] == pytest.approx(1.0 / 21.0, abs=1e-3)
    assert out[-1] == pytest.approx(30.0 + 30.0 / 21.0, abs=0.05)


def test_a_bristle_that_the_drive_bends_holds_back_by_dahls_curve():
    motion = line(0.0, 10.0, 400)
    out = answer(motion, Piece(Friction("driven"), np.array([2.0, 2.0, 1.0])))
    expected = motion.drive - (1.0 - np.exp(-motion.drive / 2.0))
    np.testing.assert_allclose(out, expected, atol=1e-9)


@pytest.mark.parametrize("release", [0.0, 1.0, 2.5])
def test_a_bristle_that_the_drive_bends_moves_nothing_against_the_drive(release):
    motion = line(0.0, 10.0, 400)
    drive = np.concatenate([motion.drive, motion.drive[::-1]])
    motion = Motion(drive, np.arange(800.0), np.zeros(800, dtype=int))
    out = answer(motion, Piece(Friction("driven"), np.array([6.0, 0.5, release])))
    assert np.all(np.diff(out) * np.diff(drive) >= -1e-12)


def test_a_bristle_that_lets_go_faster_than_it_takes_hold_carries_the_joint_on():
    motion = line(0.0, 10.0, 401)
    drive = np.concatenate([motion.drive, motion.drive[-2::-1]])
    motion = Motion(drive, np.arange(801.0), np.zeros(801, dtype=int))
    out = answer(motion, Piece(Friction("driven on"), np.array([2.0, 0.5, 1.0])))
    slope = np.diff(out) / np.diff(drive)
    assert np.all(slope[:400] >= 0.0)
    assert slope[400] == pytest.approx(-1.0, abs=0.05)
    np.testing.assert_allclose(out[-1], 1.0, atol=1e-3)


@pytest.mark.parametrize("release", [0.0, 1.0, 2.5])
def test_a_bristle_follows_its_equation_where_the_wire_is_stiff(release):
    """f' = k (1 - f / limit) with the motion, k (1 + release |f| / limit) while it still helps."""
    motion = line(0.0, 10.0, 400)
    drive = np.concatenate([motion.drive, motion.drive[::-1], motion.drive])
    motion = Motion(drive, np.arange(1200.0), np.zeros(1200, dtype=int))
    theta = answer(motion, Piece(Friction("bristle"), np.array([0.2, 2.0, release])))
    force, expected = 0.0, np.zeros(1200)
    for i, step in enumerate(np.diff(theta, prepend=theta[0])):
        for _ in range(50):
            share = force * np.sign(step) / 0.1
            force += step / 50 * 0.05 * (1.0 - (share if share > 0 else release * share))
        expected[i] = force
    np.testing.assert_allclose(drive - theta, expected, atol=2e-4)


def test_a_bristle_goes_on_where_it_was():
    motion = triangle(2)
    piece = Piece(Friction("bristle asymmetric"), np.array([5.0, 4.0, 0.6, 0.3]))
    whole = answer(motion, piece)
    first, state = Mechanism(pieces=(piece,)).respond(motion.rows(slice(0, 130)))
    second = Mechanism(pieces=(piece,)).respond(motion.rows(slice(130, None)), state)[0]
    np.testing.assert_allclose(np.concatenate([first, second]), whole, atol=1e-6)


def test_another_axis_pulls_the_wires_of_a_curved_joint():
    motion, curve = triangle(1), CubicCurve(0.7, 2e-5)
    motion = Motion(motion.drive, motion.time_s, motion.cycle, {"yaw": np.sin(motion.time_s)})
    pulled = Mechanism(curve, (Piece(Coupling("yaw"), np.array([1.4, 0.0])),)).respond(motion)[0]
    expected = curve(motion.drive + 2.0 * motion.others["yaw"])
    np.testing.assert_allclose(pulled, expected, atol=1e-5)


def test_a_wire_with_a_toe_is_soft_at_first_and_hardens_with_its_stretch():
    softness, reach, stretch, stiffness = values = np.array([0.4, 12.0, 0.05, 0.1])
    motion = line(-40.0, 40.0, 8001)
    theta = answer(motion, Piece(SoftWire("toe"), values))
    slope = np.gradient(motion.drive, theta) - 1.0 - stretch
    assert slope[4000] == pytest.approx(softness, rel=1e-3)
    assert np.interp(reach * np.log(2.0), theta, slope) == pytest.approx(softness / 2, rel=1e-3)
    elongation = motion.drive - theta + (stiffness - stretch) * theta
    toe = softness / (softness + stiffness)

    def pull(length: float) -> np.ndarray:
        gone = -np.expm1(-np.abs(elongation) / length)
        return elongation - toe * length * np.sign(elongation) * gone

    length = brentq(lambda x: pull(x)[-1] - stiffness * theta[-1], 0.01, 100.0)
    np.testing.assert_allclose(pull(length), stiffness * theta, atol=1e-4)


def test_a_wire_that_hung_slack_has_its_toe_beyond():
    motion, slack = line(-40.0, 40.0, 81), Piece(Slack(), np.array([20.0, 0.0, 0.05, 0.1]))
    toe = Piece(SoftWire("toe"), np.array([0.4, 6.0, 0.0, 0.1]))
    both, alone = answer(motion, slack, toe), answer(motion, toe)
    np.testing.assert_allclose(both[35:46], 0.0, atol=0.02)
    np.testing.assert_allclose(both[51:], alone[41:71], atol=0.02)


def test_a_ripple_counts_from_where_the_drive_is_zero_or_from_its_mean():
    motion = line(-30.0, 30.0, 61)
    first, second, third = 2.0 * np.sin(1.1), 0.4 * np.sin(2.0), 0.7 * np.sin(0.6)
    mean = {"first": first, "second": first + second, "both": first + second + third}
    waves = [2.0, 13.0, 1.1, 0.4, 2.0, 0.7, 0.6]
    for form, values in (("first", waves[:3]), ("second", waves[:5]), ("both", waves)):
        homed = answer(motion, Piece(TransmissionRipple(form), np.array(values)))
        afloat = answer(motion, Piece(TransmissionRipple(f"{form} afloat"), np.array(values)))
        assert homed[30] == pytest.approx(0.0, abs=1e-12)
        np.testing.assert_allclose(afloat - homed, mean[form], atol=1e-12)


def test_the_longer_of_two_waves_may_be_told_as_an_overtone():
    motion = line(-30.0, 30.0, 61)
    ripple = TransmissionRipple("second")
    same, longer = ripple.retold(np.array([[2.0, 13.0, 1.1, 0.0, 0.3]]))
    np.testing.assert_allclose(
        answer(motion, Piece(ripple, longer)), answer(motion, Piece(ripple, same)), atol=1e-12
    )
    assert longer[1] == 26.0


def test_overtones_that_go_on_are_a_geometric_series():
    motion, size, fall, phase = line(-30.0, 30.0, 61), 2.0, 0.3, 1.1
    turn = 2.0 * np.pi * motion.drive / 13.0 + phase
    values = [size, 13.0, phase]
    for times in (2, 3):
        values += [size * fall ** (times - 1), times * phase]
    seen = answer(motion, Piece(TransmissionRipple("all afloat"), np.array([*values, fall])))
    every = size * np.sin(turn) / (1.0 - 2.0 * fall * np.cos(turn) + fall**2)
    np.testing.assert_allclose(seen - motion.drive, every, atol=3e-4)
    odd = [*values[:3], size * fall**2, 3.0 * phase, fall**2]
    seen = answer(motion, Piece(TransmissionRipple("odd afloat"), np.array(odd)))
    other = -size * np.sin(turn + np.pi) / (1.0 - 2.0 * fall * np.cos(turn + np.pi) + fall**2)
    np.testing.assert_allclose(seen - motion.drive, 0.5 * (every + other), atol=3e-4)


@pytest.mark.parametrize(("late_term", "values"), [(ResponseLag(), [2.0]), (Creep(), [0.3, 5.0])])
def test_dwells_of_any_length_are_followed_exactly(late_term, values):
    rng = np.random.default_rng(5)
    dwell = np.where(rng.random(400) < 0.1, 9.0, 3.0) + rng.uniform(-0.05, 0.05, 400)
    command = np.cumsum(rng.normal(size=400))
    motion = Motion(command, np.cumsum(dwell), np.zeros(400, dtype=int))
    seen = Mechanism(pieces=[Piece(late_term, np.array(values))]).trace(motion).seen
    late, expected = command[0], np.empty(400)
    share, tau = (1.0, *values)[-2:]
    for i in range(400):
        late += (command[i] - late) * (-np.expm1(-dwell[i] / tau) if i else 0.0)
        expected[i] = (1.0 - share) * command[i] + share * late
    assert seen == pytest.approx(expected, abs=1e-8)


def test_slack_at_home_is_slack_whose_centre_is_zero():
    motion = line(-20.0, 20.0, 81)
    home = answer(motion, Piece(Slack("home"), np.array([8.0, 0.3, 0.05])))
    np.testing.assert_allclose(
        home, answer(motion, Piece(Slack(), np.array([8.0, 0.0, 0.3, 0.05])))
    )
    aside = Surroundings(drive_low=5.0, drive_span=60.0)
    assert [t.form for t in (Slack("home"), Slack()) if t.excited(motion, aside)] == [""]


def test_a_motor_that_is_late_moves_the_play_behind_it():
    time_s = np.arange(400) * 0.02
    motion = Motion(20.0 * np.sin(3.0 * time_s), time_s, np.zeros(400, dtype=int))
    lag = Piece(SecondOrderLag("motor"), np.array([25.0, 0.3, 1.0]))
    late = Motion(answer(motion, lag), time_s, motion.cycle)
    play = Piece(Backlash(), np.array([4.0]))
    np.testing.assert_allclose(answer(motion, play, lag), answer(late, play))


def test_a_wire_round_a_bend_rubs_the_more_the_further_it_is_bent():
    motion = line(0.0, 60.0, 601)
    out = answer(motion, Piece(Friction("wrapped"), np.array([2.0, 0.5, 0.0, 0.02])))
    slides = motion.drive > 5.0
    expected = 1.0 + 0.02 * np.abs(out)
    np.testing.assert_allclose((motion.drive - out)[slides], expected[slides], atol=3e-3)


def test_a_contact_that_hardens_pushes_by_the_square_of_its_depth():
    motion = line(0.0, 60.0, 601)
    out = answer(motion, Piece(Contact("upper hardening"), np.array([0.1, 30.0, 0.01, 0.02])))
    depth = np.maximum(out - 30.0, 0.0)
    np.testing.assert_allclose(motion.drive - out, depth * (0.1 + 0.02 * depth), atol=0.01)


@pytest.mark.parametrize(("flank", "kept"), [(3.0, 0.3), (10.0, 0.6), (2.0, 0.0), (1.0, 1.0)])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_lossy_contact_gives_back_less_than_it_took(flank: float, kept: float, side: float):
    turns = np.array([0.0, 40.0, 10.0, 35.0, 0.0])
    drive = side * np.concatenate([np.linspace(a, b, 31) for a, b in pairwise(turns)])
    motion = Motion(drive, np.arange(float(len(drive))), np.zeros(len(drive), dtype=int))
    form = Contact("upper lossy" if side > 0.0 else "lower lossy")
    pad = Piece(form, np.array([0.8, side * 20.0, 1e-3, flank, kept]))
    push, at, expected = 0.0, 0.0, []
    for asked in np.abs(drive):

        def pushed(angle, push=push, at=at):
            first = 0.8 * max(angle - 20.0, 0.0)
            return min(first, max(kept * first, push + flank * 0.8 * (angle - at)))

        at = brentq(lambda angle, asked=asked, f=pushed: angle + f(angle) - asked, -1.0, 50.0)
        push = pushed(at)
        expected.append(at)
    np.testing.assert_allclose(side * answer(motion, pad), expected, atol=1e-3)
    whole, blocks = Mechanism(pieces=(pad,)), []
    state = None
    for rows in (slice(0, 70), slice(70, None)):
        part, state = whole.respond(motion.rows(rows), state)
        blocks.append(part)
    np.testing.assert_allclose(np.concatenate(blocks), answer(motion, pad), atol=1e-9)


def test_a_joint_that_drags_alone_lags_the_same_in_the_balance_as_after_it():
    time_s = np.cumsum(np.random.default_rng(1).uniform(0.01, 0.3, 200))
    motion = Motion(10.0 * np.sin(time_s), time_s, np.zeros(200, dtype=int))
    for late_s in (0.0, 1e-3, 0.5, 1e4):
        loaded = answer(motion, Piece(ResponseLag(LOADED), np.array([late_s])))
        after = answer(motion, Piece(ResponseLag(RUNNING), np.array([late_s])))
        np.testing.assert_allclose(loaded, after, atol=1e-6)

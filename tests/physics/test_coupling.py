"""Another axis's command: what it does to a joint by its speed, late, or by a lever."""

import numpy as np
import pytest

from pipeline.physics.coupling import Coupling
from pipeline.physics.end_stop import EndStop
from pipeline.physics.kinematics import CubicCurve
from pipeline.physics.mechanism import Mechanism
from pipeline.physics.motion import Motion
from pipeline.physics.piece import Piece
from pipeline.physics.term import Surroundings
from pipeline.physics.turned_gravity import TurnedGravity

YAW = "yaw"


def moved(yaw: np.ndarray, drive: np.ndarray | float = 0.0, dwell_s: float = 3.0) -> Motion:
    n = len(yaw)
    return Motion(np.zeros(n) + drive, dwell_s * np.arange(n), np.zeros(n, dtype=int), {YAW: yaw})


def answer(form: str, values: list[float], motion: Motion) -> np.ndarray:
    piece = Piece(Coupling(f"{YAW}/{form}"), np.array(values))
    return Mechanism(CubicCurve(0.7, 0.0), (piece,)).respond(motion)[0]


@pytest.mark.parametrize(("dwell_s", "taken_s"), [(0.1, 0.1), (3.0, 0.5), (9.0, 0.5)])
def test_a_step_drags_by_its_speed_and_takes_no_longer_than_a_step_does(dwell_s, taken_s):
    yaw = np.array([0.0, 0.0, 6.0, 9.0, 9.0])
    found = answer("rate", [0.02], moved(yaw, 10.0, dwell_s))
    wanted = 7.0 + 0.02 * np.array([0.0, 0.0, 6.0, 3.0, 0.0]) / taken_s
    np.testing.assert_allclose(found, wanted, atol=1e-9)


def test_what_was_dragged_along_is_let_go_with_a_time_constant():
    yaw = np.array([0.0, 0.0, 6.0, 6.0, 6.0])
    found = answer("late", [0.1, 0.0, 0.2, 4.0], moved(yaw))
    left = np.exp(-np.array([3.0, 6.0, 9.0]) / 4.0)
    np.testing.assert_allclose(found[2:], 0.6 + 1.2 * left, atol=1e-9)


def test_a_coupling_that_lets_go_of_all_of_its_gain_comes_late_as_a_whole():
    yaw = 30.0 * np.sin(np.arange(200) / 9.0)
    found, late = answer("late", [0.1, 0.0, -0.1, 6.0], moved(yaw)), 0.0
    for k, now in enumerate(yaw):
        late += (now - late) * (1.0 - np.exp(-3.0 / 6.0))
        assert found[k] == pytest.approx(0.1 * late, abs=1e-9)


@pytest.mark.parametrize("way", ["cubic", "cubic/direct"])
def test_a_cubic_is_the_power_series_on_to_its_third_term(way):
    yaw = np.linspace(-30.0, 30.0, 61)
    found = answer(way, [0.1, 0.002, -3e-5], moved(yaw))
    np.testing.assert_allclose(found, 0.1 * yaw + 0.002 * yaw**2 - 3e-5 * yaw**3, atol=1e-9)
    assert Coupling(f"{YAW}/{way}").unlikely > Coupling(YAW).unlikely


def test_a_lever_that_the_other_axis_turns_away_is_about_its_cosine():
    yaw, drive = np.linspace(-30.0, 30.0, 61), np.linspace(-50.0, 50.0, 61)
    found = answer("lever", [0.0, -0.5 * (np.pi / 180.0) ** 2], moved(yaw, drive))
    np.testing.assert_allclose(found, 0.7 * drive * np.cos(np.radians(yaw)), atol=0.12)
    turned = answer("lever", [0.01, 0.0], moved(yaw, drive))
    np.testing.assert_allclose(turned, 0.7 * drive * (1.0 + 0.01 * yaw), atol=1e-9)


@pytest.mark.parametrize("way", ["", "/torque", "/direct"])
def test_wires_are_pulled_as_the_curve_is_steep_and_a_stop_holds_what_is_no_turn(way: str):
    curve, motion = CubicCurve(0.7, 1e-4), moved(np.full(61, 20.0), np.linspace(0.0, 60.0, 61))
    piece = Piece(Coupling(f"{YAW}{way}"), np.array([0.1, 0.0]))
    free = Mechanism(curve, (piece,)).respond(motion)[0] - curve(motion.drive)
    pulled = curve(motion.drive + 2.0 / curve.slope) - curve(motion.drive)
    np.testing.assert_allclose(free, 2.0 if way else pulled, atol=1e-6)
    stop = Piece(EndStop("upper"), np.array([15.0, 0.05, 0.004]))
    held = Mechanism(curve, (piece, stop)).respond(motion)[0]
    assert held[-1] == pytest.approx(17.0 if way == "/direct" else 15.0, abs=0.3)


def test_the_channel_of_a_form_is_what_stands_before_the_last_slash():
    for form in ("", "/play", "/late", "/rate", "/lever", "/direct", "/torque"):
        assert Coupling(f"/joint/cmd{form}").channel == "/joint/cmd"


def test_only_a_command_that_is_held_drags_late():
    late, motion = Coupling(f"{YAW}/late"), moved(np.arange(5.0))
    spans = {YAW: 4.0}
    assert late.excited(motion, Surroundings(dwell_s=3.0, other_span=spans))
    assert not late.excited(motion, Surroundings(dwell_s=0.02, other_span=spans))


def test_a_weight_that_the_other_axis_turns_away_hangs_in_balance():
    yaw, drive = np.linspace(-40.0, 40.0, 81), np.linspace(60.0, -60.0, 81)
    piece = Piece(TurnedGravity(f"{YAW}/turned"), np.array([12.0, 0.6, np.pi / 180.0]))
    found = Mechanism(CubicCurve(0.7, 0.0), (piece,)).respond(moved(yaw, drive))[0]
    bent = 12.0 * (np.sin(np.radians(found) - 0.6) * np.cos(np.radians(yaw)) + np.sin(0.6))
    np.testing.assert_allclose(found + bent, 0.7 * drive, atol=1e-6)


def test_what_the_other_axis_turns_away_of_a_weight_that_sags_is_its_whole_moment():
    yaw, drive = np.linspace(-40.0, 40.0, 81), np.linspace(60.0, -60.0, 81)
    piece = Piece(TurnedGravity(f"{YAW}/turned sagging"), np.array([12.0, 0.6, np.pi / 180.0]))
    found = Mechanism(CubicCurve(0.7, 0.0), (piece,)).respond(moved(yaw, drive))[0]
    bent = 12.0 * np.sin(np.radians(found) - 0.6) * np.cos(np.radians(yaw))
    np.testing.assert_allclose(found + bent, 0.7 * drive, atol=1e-6)
    assert piece.term.channel == YAW


@pytest.mark.parametrize("way", ["play", "late"])
def test_a_wire_that_drags_turns_what_a_joint_stands_on_whatever_its_curve(way: str):
    yaw, drive = 30.0 * np.sin(np.arange(200) / 9.0), np.linspace(-60.0, 60.0, 200)
    values = [0.1, 0.001, -0.05, 8.0]
    straight = answer(way, values, moved(yaw)), answer(f"{way}/direct", values, moved(yaw))
    np.testing.assert_allclose(*straight, atol=1e-6)
    curve, pulled = CubicCurve(0.7, 1e-5), moved(yaw, drive)
    piece = Piece(Coupling(f"{YAW}/{way}/direct"), np.array(values))
    found = Mechanism(curve, (piece,)).respond(pulled)[0]
    np.testing.assert_allclose(found, curve(drive) + straight[1], atol=1e-9)


def test_two_axes_that_drag_each_remember_their_own_way():
    other = 20.0 * np.cos(np.arange(200) / 7.0)
    yaw = 30.0 * np.sin(np.arange(200) / 9.0)
    whole = Motion(np.zeros(200), 3.0 * np.arange(200), np.zeros(200, dtype=int),
                   {YAW: yaw, "roll": other})  # fmt: skip
    values = np.array([0.1, 0.0, -0.1, 8.0])
    pieces = [Piece(Coupling(f"{axis}/play/direct"), values) for axis in (YAW, "roll")]
    mechanism = Mechanism(CubicCurve(0.7, 0.0), pieces)
    first, state = mechanism.respond(whole.rows(slice(0, 90)))
    rest = mechanism.respond(whole.rows(slice(90, 200)), state)[0]
    np.testing.assert_allclose(np.concatenate([first, rest]), mechanism.respond(whole)[0])


@pytest.mark.parametrize("place", ["", "/direct"])
def test_each_way_to_drag_leads_to_the_other_one_at_the_same_place(place):
    for way, other in (("play", "late"), ("late", "play")):
        richer = {t.form for t in Coupling(f"{YAW}/{way}{place}").richer()}
        assert f"{YAW}/{other}{place}" in richer

"""The plant against what mechanics says of each of its parts."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from pipeline.concealed.camera import Camera
from pipeline.concealed.motions import MOVE_S, RECORDED_CYCLES, Motion, plain_motion, rich_motion
from pipeline.concealed.plant import BRISTLES, WIRE_STIFFNESS, Nominal, Plant, respond

IDEAL = Plant(nominal=Nominal(gain=0.7, cubic=2e-6))
SPRINGS = 2 * WIRE_STIFFNESS / 0.7  # of the joint in the ideal plant, over its lever


def motion_of(pitch_deg: np.ndarray, interval_s: float = 3.36, yaw_deg: float = 0.0) -> Motion:
    n = len(pitch_deg)
    time = interval_s * np.arange(1, n + 1)
    return Motion(time, np.zeros(n, int), np.arange(n), pitch_deg, np.full(n, yaw_deg))


def sweep(*corners: float, step: float = 0.5) -> Motion:
    parts = [np.arange(a, b, np.sign(b - a) * step) for a, b in pairwise(corners)]
    return motion_of(np.concatenate([*parts, [corners[-1]]]))


@pytest.fixture
def plain() -> Motion:
    return plain_motion(np.random.default_rng(1)).head(RECORDED_CYCLES)


def change(plant: Plant, motion: Motion) -> np.ndarray:
    return respond(plant, motion) - plant.nominal.angle_deg(motion.pitch_deg)


@pytest.mark.parametrize("draw", [plain_motion, rich_motion])
def test_an_ideal_plant_follows_the_nominal_curve(draw):
    motion = draw(np.random.default_rng(2))
    assert np.abs(change(IDEAL, motion)).max() < 1e-9
    homed = replace(IDEAL, homing_deg=-20.0)
    assert np.abs(change(homed, motion)).max() < 1e-9


def test_clearance_loses_its_whole_width_after_a_reversal_with_sharp_corners():
    plant = replace(IDEAL, clearance_deg=6.0, nominal=Nominal(0.7))
    motion = sweep(0, 40, 0)
    angle = respond(plant, motion)
    top = int(np.argmax(motion.pitch_deg))
    back = angle[top:]
    assert angle[top] == pytest.approx(0.7 * 37.0, abs=1e-6)
    assert back[12] == pytest.approx(angle[top], abs=1e-6)
    assert back[13] == pytest.approx(angle[top] - 0.35, abs=1e-6)


def test_homing_leaves_the_drum_at_one_flank():
    plant = replace(IDEAL, clearance_deg=6.0, homing_deg=20.0)
    angle = respond(plant, sweep(0, 20))
    assert angle[0] == pytest.approx(0.7 * 3.0, abs=1e-3)


def test_sheath_friction_rounds_the_corners_and_closes_minor_loops():
    plant = replace(IDEAL, nominal=Nominal(0.7), sheath_torque=100.0)
    motion = sweep(0, 40, -40, 40, 20, 30, 20, 40)
    late = change(plant, motion)
    reversal = int(np.argmin(motion.pitch_deg))
    slopes = np.diff(respond(plant, motion)[reversal : reversal + 60])
    stuck = np.sum(100.0 / BRISTLES / np.geomspace(1.0, 8.0, BRISTLES))
    assert slopes[0] / slopes[-1] == pytest.approx(SPRINGS / (SPRINGS + stuck), rel=0.02)
    assert np.all(np.diff(slopes) > -1e-6)
    assert late[reversal - 1] == pytest.approx(100.0 / SPRINGS, rel=0.01)
    first, again = np.flatnonzero(motion.pitch_deg[reversal:] == 20.0)[1:3] + reversal
    assert late[first] == pytest.approx(late[again], abs=1e-6)


def test_asymmetric_sheath_shifts_the_loop():
    plant = replace(IDEAL, nominal=Nominal(0.7), sheath_torque=100.0, sheath_asymmetry=0.3)
    late = change(plant, sweep(0, 50, -50, 50))
    assert late.min() == pytest.approx(-1.3 * 100.0 / SPRINGS, rel=0.02)
    assert late.max() == pytest.approx(0.7 * 100.0 / SPRINGS, rel=0.02)


def test_slack_wires_leave_the_joint_at_home_without_a_loop():
    plant = replace(IDEAL, pretension_deg=-3.0)
    motion = sweep(0, 30, -30, 0)
    angle = respond(plant, motion)
    assert np.abs(angle[np.abs(motion.pitch_deg) < 2.9]).max() < 0.02
    up = np.interp(20.0, motion.pitch_deg[:60], angle[:60])
    down = np.interp(-20.0, motion.pitch_deg[60:180][::-1], angle[60:180][::-1])
    assert up == pytest.approx(0.7 * 17.0, abs=0.5)
    assert up == pytest.approx(-down, abs=1e-6)


def test_soft_wires_lower_the_gain_and_harden():
    plant = replace(
        IDEAL,
        nominal=Nominal(0.7),
        pretension_deg=0.0,
        wire_softness=2.0,
        toe_share=0.2,
        toe_deg=6.0,
    )
    slope = np.gradient(respond(plant, sweep(0, 50)), 0.5)
    assert slope[2] < slope[20] < slope[-2] < 0.7


@pytest.mark.parametrize("interval_s", [1.0, 4.0, 20.0])
def test_a_dashpot_lets_part_of_a_step_arrive_late(interval_s):
    share, tau = 0.2, 50.0
    branch = share * 2 * WIRE_STIFFNESS
    pitch = np.concatenate([[0.0], np.full(int(400 / interval_s), 20.0)])
    plant = replace(IDEAL, nominal=Nominal(0.7), dashpot_share=share, dashpot_s=tau)
    angle = respond(plant, motion_of(pitch, interval_s))
    free = tau * (SPRINGS + branch) / SPRINGS
    assert angle[-1] == pytest.approx(14.0, rel=1e-2)
    samples = np.array([20, 60, 120]) // int(interval_s)
    missing = (
        14.0 * branch / (SPRINGS + branch) * np.exp(-(samples * interval_s - MOVE_S / 2) / free)
    )
    assert 14.0 - angle[samples] == pytest.approx(missing, rel=0.02)


def test_a_viscous_body_follows_with_its_time_constant():
    pitch = np.concatenate([[0.0], np.full(60, 20.0)])
    plant = replace(IDEAL, nominal=Nominal(0.7), viscosity_s=6.0)
    angle = respond(plant, motion_of(pitch, interval_s=1.0))
    ratio = (14.0 - angle[[4, 9, 16]]) / (14.0 - angle[3])
    assert ratio == pytest.approx(np.exp(-np.array([1, 6, 13]) / 6.0), rel=5e-3)
    assert 14.0 - angle[1] == pytest.approx(14.0 * np.exp(-(1.0 - MOVE_S / 2) / 6.0), rel=0.01)
    assert angle[-1] == pytest.approx(14.0, abs=0.01)


def test_softer_wires_draw_a_viscous_body_more_slowly():
    pitch = np.concatenate([[0.0], np.full(20, 20.0)])
    plant = replace(IDEAL, nominal=Nominal(0.7), viscosity_s=3.0, wire_softness=2.5)
    angle = respond(plant, motion_of(pitch, interval_s=10.0))
    springs = 1 / 2.5 + (1 - 1 / 2.5) / SPRINGS  # of the joint, over those of the ideal plant
    left = np.exp(-10.0 * springs / 3.0)
    assert (angle[3] - angle[2]) / (angle[2] - angle[1]) == pytest.approx(left, rel=0.02)


def test_wear_widens_the_loop_from_cycle_to_cycle(plain):
    plant = replace(IDEAL, clearance_deg=1.0, wear_per_deg=0.001)
    late = change(plant, plain)
    widths = [np.ptp(late[plain.cycle == c]) for c in range(1, 9)]
    travel = 4 * plain.pitch_deg.max()
    assert np.all(np.diff(widths) > 0)
    assert np.diff(widths).mean() == pytest.approx(0.7 * 0.001 * travel, rel=0.1)


def test_gravity_bends_the_curve_on_one_side_more(plain):
    late = change(replace(IDEAL, weight=200.0, mounting_rad=np.pi / 2), plain)
    sagging = 200.0 * (np.cos(np.deg2rad(40.0)) - 1.0) / SPRINGS
    assert late[np.argmin(np.abs(plain.pitch_deg))] == pytest.approx(0.0, abs=1e-6)
    assert late.min() == pytest.approx(sagging, rel=0.15)


def test_pad_and_stop_hold_the_joint_on_their_side():
    motion = sweep(0, 50, -50, 0)
    top = np.argmax(motion.pitch_deg)
    pad = respond(replace(IDEAL, nominal=Nominal(0.7), pad_stiffness=SPRINGS, pad_deg=20.0), motion)
    stop = respond(replace(IDEAL, stop_stiffness=60 * SPRINGS, stop_high_deg=20.0), motion)
    assert pad[top] == pytest.approx(20.0 + 15.0 / 2, abs=0.3)
    assert stop.max() == pytest.approx(20.3, abs=0.3)
    assert stop.min() == pytest.approx(IDEAL.nominal.angle_deg(np.array(-50.0)), abs=1e-9)


def test_the_other_axis_pulls_and_a_slip_shifts():
    pulled = change(replace(IDEAL, other_lever=0.1), motion_of(np.zeros(9), yaw_deg=30.0))
    assert pulled[-1] == pytest.approx(0.7 * 0.1 * 30.0, rel=0.001)
    slipped = change(replace(IDEAL, slip_deg=2.0, slip_sample=5), motion_of(np.zeros(9)))
    assert slipped[:5] == pytest.approx(np.zeros(5), abs=1e-9)
    assert slipped[5:] == pytest.approx(np.full(4, 1.4), abs=1e-4)


def test_an_eccentric_wheel_repeats_over_the_shaft_angle():
    plant = replace(IDEAL, nominal=Nominal(0.7), mesh_deg=1.0, mesh_period_deg=15.0)
    late = change(plant, sweep(0, 45))
    assert late[30] == pytest.approx(late[60], abs=1e-9)
    assert np.ptp(late) == pytest.approx(1.4, rel=0.01)


def test_an_eccentric_drum_repeats_over_the_drums_angle_behind_its_clearance():
    ideal = replace(IDEAL, nominal=Nominal(0.7))
    plant = replace(ideal, clearance_deg=6.0, mesh_deg=1.0, mesh_period_deg=15.0)
    motion = sweep(0, 45, 0)
    played = respond(replace(plant, mesh_deg=0.0), motion) / 0.7
    behind = respond(replace(plant, mesh_on_drum=True), motion) / 0.7
    assert behind - played == pytest.approx(np.sin(2 * np.pi * played / 15), abs=1e-6)
    ahead = respond(plant, motion) / 0.7
    assert np.abs(ahead - behind).max() > 1.0


def test_a_wire_that_slips_on_its_drum_leaves_shaft_play_and_mesh_where_they_were():
    plant = replace(IDEAL, nominal=Nominal(0.7), clearance_deg=6.0, mesh_deg=1.0)
    motion = sweep(0, 45, 0)
    late = np.arange(len(motion.pitch_deg)) >= 120
    slip = replace(plant, slip_deg=2.0, slip_sample=120)
    on_drum = respond(replace(slip, slip_on_drum=True), motion) - respond(plant, motion)
    assert on_drum == pytest.approx(1.4 * late, abs=1e-6)
    of_motor = respond(slip, motion) - respond(plant, motion)
    assert np.abs(of_motor[late] - 1.4).max() > 0.5


def test_the_camera_sees_a_projection():
    motion = sweep(0, 50)
    seen = respond(replace(IDEAL, camera=Camera(tilt_deg=20.0)), motion)
    pose = np.deg2rad(IDEAL.nominal.angle_deg(motion.pitch_deg))
    expected = np.rad2deg(np.arctan2(np.sin(pose) * np.cos(np.deg2rad(20.0)), np.cos(pose)))
    assert seen == pytest.approx(expected, abs=1e-9)


def test_a_lens_centred_on_the_joint_turns_nothing():
    motion = sweep(0, 50)
    assert np.abs(change(replace(IDEAL, camera=Camera(barrel=0.3)), motion)).max() < 1e-9
    off = replace(IDEAL, camera=Camera(barrel=0.3, centre_x_mm=4.0))
    assert np.abs(change(off, motion)).max() > 0.3


@pytest.mark.parametrize("kind", ["linear", "settling", "stairs"])
def test_the_mount_wanders_its_whole_way(plain, kind):
    late = change(replace(IDEAL, camera=Camera(wander_deg=2.0, wander_kind=kind)), plain)
    assert late[0] == pytest.approx(0.0, abs=1e-9)
    assert late[-1] == pytest.approx(2.0, abs=1e-9)


def test_stale_frames_show_an_earlier_pose(plain):
    nominal = IDEAL.nominal.angle_deg(plain.pitch_deg)
    seen = respond(replace(IDEAL, camera=Camera(stale_frames=2)), plain)
    assert seen[2:] == pytest.approx(nominal[:-2], abs=1e-9)
    late = respond(replace(IDEAL, camera=Camera(stale_s=3.36)), plain)
    assert late[2:] == pytest.approx(nominal[1:-1], abs=0.02)


def test_a_tip_swings_after_a_step_as_an_oscillator_does():
    plant = replace(IDEAL, nominal=Nominal(0.7), swing_s=2.0, swing_damping=0.3)
    motion = motion_of(np.array([0.0, *[10.0] * 59]), interval_s=MOVE_S)
    angle = respond(plant, motion)
    root = np.sqrt(1.0 - 0.3**2)
    peak = 7.0 * (1.0 + np.exp(-np.pi * 0.3 / root))
    assert angle.max() == pytest.approx(peak, abs=0.05)
    when = MOVE_S * np.argmax(angle) - 1.5 * MOVE_S
    assert when == pytest.approx(np.pi * 2.0 / root, abs=MOVE_S)

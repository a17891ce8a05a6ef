"""The plant: shaft, gear and drum, wires and joint, camera; every part ideal unless told."""

from dataclasses import dataclass, field

import numpy as np

from pipeline.concealed import gear
from pipeline.concealed.camera import Camera, seen_deg
from pipeline.concealed.motions import MOVE_S, Motion
from pipeline.concealed.outside import OUTSIDE
from pipeline.concealed.swing import tip_deg
from pipeline.concealed.wires import CONSTANTS, joint_path

WIRE_STIFFNESS = 20.0
BRISTLES = 24
HOMING_STEP_S = 0.5
FIRST_INTERVAL_S = 3.36


@dataclass(frozen=True)
class Nominal:
    """The simulation: angle = gain q + cubic q^3, q the shaft angle [deg]."""

    gain: float = 0.7
    cubic: float = 0.0

    def angle_deg(self, command_deg: np.ndarray) -> np.ndarray:
        """Simulated angle [deg], shape of `command_deg`."""
        return np.asarray(self.gain * command_deg + self.cubic * command_deg**3)


@dataclass(frozen=True)
class Plant:
    """All parts; the defaults do nothing, and the joint then follows the nominal curve.

    A slip and an uneven gear stand before the clearance, on the motor's side, unless they are on
    the drum. Torques are in units of the joint's bending stiffness times a degree; `viscosity_s` is
    the time constant with which a viscous body follows its wires, `swing_s` that of the swing of a
    tip behind it.
    """

    nominal: Nominal = field(default_factory=Nominal)
    slip_deg: float = 0.0
    slip_sample: int = 0
    slip_on_drum: bool = False
    mesh_deg: float = 0.0
    mesh_period_deg: float = 20.0
    mesh_phase: float = 0.0
    mesh_overtone: float = 0.0
    mesh_on_drum: bool = False
    clearance_deg: float = 0.0
    wear_per_deg: float = 0.0
    wear_saturation_deg: float = 0.0
    wear_onset_deg: float = 0.0
    pretension_deg: float = 12.0
    straightening_deg: float = 0.0
    wire_softness: float = 1.0
    toe_share: float = 1.0
    toe_deg: float = 0.0
    sheath_torque: float = 0.0
    presliding_low_deg: float = 1.0
    presliding_high_deg: float = 8.0
    sheath_asymmetry: float = 0.0
    capstan: float = 0.0
    dashpot_share: float = 0.0
    dashpot_s: float = 60.0
    second_dashpot_share: float = 0.0
    second_dashpot_s: float = 300.0
    viscosity_s: float = 0.0
    swing_s: float = 0.0
    swing_damping: float = 0.7
    weight: float = 0.0
    mounting_rad: float = 1.5
    pad_stiffness: float = 0.0
    pad_deg: float = 30.0
    pad_side: float = 1.0
    pad_skin_deg: float = 1.0
    stop_stiffness: float = 0.0
    stop_high_deg: float = 1e6
    stop_low_deg: float = 1e6
    stop_skin_deg: float = 0.5
    other_lever: float = 0.0
    other_lever_even: float = 0.0
    camera: Camera = field(default_factory=Camera)
    outside: str | None = None
    outside_parameters: dict[str, float] = field(default_factory=dict)
    homing_deg: float = 0.0


def respond(plant: Plant, motion: Motion, span_s: float | None = None) -> np.ndarray:
    """What an ideal reader of the camera's frames would measure [deg], shape (n,).

    `span_s` is the time over which the camera's mount wanders its whole way (default: all).
    """
    joint = joint_deg(plant, motion)
    if plant.swing_s > 0.0:
        interval_s = np.diff(motion.time_s, prepend=motion.time_s[0] - FIRST_INTERVAL_S)
        joint = tip_deg(joint, interval_s, MOVE_S, plant.swing_s, plant.swing_damping)
    if plant.outside is not None:
        joint = OUTSIDE[plant.outside](motion, joint, plant.outside_parameters)
    span = float(motion.time_s[-1] - motion.time_s[0]) if span_s is None else span_s
    return seen_deg(plant.camera, joint, motion.time_s, motion.cycle, span)


def joint_deg(plant: Plant, motion: Motion) -> np.ndarray:
    """True angle of the joint [deg] at each sample, shape (n,)."""
    before = _homing(plant.homing_deg)
    skip = len(before)
    shaft = np.concatenate([before, motion.pitch_deg])
    slip = plant.slip_deg * (np.arange(len(shaft)) >= skip + plant.slip_sample)
    uneven = np.array([getattr(plant, name) for name in gear.GEAR])
    even = uneven * (np.arange(len(uneven)) != gear.AMPLITUDE)
    at_motor, on_drum = (even, uneven) if plant.mesh_on_drum else (uneven, even)
    turned = shaft + slip * (not plant.slip_on_drum)
    turned = turned + gear.error_deg(turned, at_motor)
    yaw = np.concatenate([np.zeros(skip), motion.yaw_deg])
    outer = 2 * WIRE_STIFFNESS * (plant.other_lever * yaw + plant.other_lever_even * yaw**2 / 40.0)
    interval = np.diff(motion.time_s, prepend=motion.time_s[0] - FIRST_INTERVAL_S)
    interval = np.concatenate([np.full(skip, HOMING_STEP_S), interval])
    reach, stiffness = _bristles(plant)
    dashpot_k, dashpot_s = _dashpots(plant)
    clearance = np.array(
        [0.5 * plant.clearance_deg, 0.5 * plant.wear_per_deg, plant.wear_saturation_deg,
         plant.wear_onset_deg]
    )  # fmt: skip
    path = joint_path(
        turned, slip * plant.slip_on_drum, on_drum, outer, interval, MOVE_S, _constants(plant),
        clearance, reach, stiffness, dashpot_k, dashpot_s, plant.viscosity_s,
    )  # fmt: skip
    return np.asarray(path[skip:])


def _homing(far_deg: float) -> np.ndarray:
    """Shaft angles of a way out and home before the recording, shape (m,)."""
    if far_deg == 0.0:
        return np.zeros(0)
    way = np.linspace(0.0, far_deg, 15)
    return np.concatenate([way, way[-2::-1]])


def _bristles(plant: Plant) -> tuple[np.ndarray, np.ndarray]:
    """Reach [deg] before each bristle slips, and its stiffness; together `sheath_torque`."""
    if plant.sheath_torque == 0.0:
        return np.zeros(0), np.zeros(0)
    reach = np.geomspace(plant.presliding_low_deg, plant.presliding_high_deg, BRISTLES)
    return reach, plant.sheath_torque / BRISTLES / reach


def _dashpots(plant: Plant) -> tuple[np.ndarray, np.ndarray]:
    """Stiffness and time constant of the body's Maxwell branches."""
    whole = 2 * WIRE_STIFFNESS
    shares = np.array([plant.dashpot_share, plant.second_dashpot_share])
    used = shares > 0
    return whole * shares[used], np.array([plant.dashpot_s, plant.second_dashpot_s])[used]


def _constants(plant: Plant) -> np.ndarray:
    """The numbers that `wires.balance` reads, as `wires.CONSTANTS` orders them."""
    derived = {
        "wire_stiffness": WIRE_STIFFNESS / plant.wire_softness,
        "nominal_wire_stiffness": WIRE_STIFFNESS,
        "gain": plant.nominal.gain,
        "cubic": plant.nominal.cubic,
        "grip_up": 1.0 + plant.sheath_asymmetry,
        "grip_down": 1.0 - plant.sheath_asymmetry,
    }
    return np.array([derived.get(n, getattr(plant, n, 0.0)) for n in CONSTANTS], dtype=float)

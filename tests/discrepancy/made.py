"""Recordings made of the project's own terms, with known truth."""

import numpy as np
import pandas as pd

from pipeline.config import DiagnosisConfig
from pipeline.discrepancy.explain import Explanation, explain
from pipeline.discrepancy.problem import pose_problem
from pipeline.physics.catalogue import term
from pipeline.physics.kinematics import CubicCurve
from pipeline.physics.mechanism import Mechanism, Piece
from pipeline.physics.motion import Motion
from pipeline.physics.term import Surroundings, values_of
from pipeline.recording import Channel, Recording

NOISE = 0.2
AMPLITUDE = 55.0
STEPS = 120
CHANNELS = (
    Channel("pitch_command_deg", "command", "deg"),
    Channel("yaw_command_deg", "command", "deg"),
    Channel("pitch_angle_deg", "measurement", "deg"),
    Channel("pitch_angle_sim_deg", "simulation", "deg", of="pitch_angle_deg"),
)


def motion_of(cycles: int = 6, two_axes: bool = False) -> Motion:
    phase = np.arange(cycles * STEPS) % STEPS / STEPS * 4.0
    shape = np.where(phase < 1, phase, np.where(phase < 3, 2 - phase, phase - 4))
    n = len(phase)
    yaw = 30.0 * np.sin(np.arange(n) / 17.0) if two_axes else np.zeros(n)
    return Motion(
        AMPLITUDE * shape,
        3.0 + 3.36 * np.arange(n),
        np.arange(n) // STEPS,
        {"yaw_command_deg": yaw},
    )


def recorded(
    hidden: dict[str, dict[str, float]],
    *,
    seed: int = 0,
    noise: float = NOISE,
    gain: float = 1.02,
    offset: float = 0.4,
    cycles: int = 6,
    two_axes: bool = False,
) -> Recording:
    """A mechanism with hidden terms ("name/form": parameters), measured with white noise."""
    motion = motion_of(cycles, two_axes)
    around = Surroundings(
        drive_span=2 * AMPLITUDE,
        drive_low=-AMPLITUDE,
        start_s=float(motion.time_s[0]),
        end_s=float(motion.time_s[-1]),
        other_span={"yaw_command_deg": 60.0},
    )
    pieces = []
    for key, parameters in hidden.items():
        name, _, form = key.partition("/")
        physics = term(name, form, ["yaw_command_deg"])
        pieces.append(Piece(physics, values_of(physics, around, parameters)))
    curve = CubicCurve(0.7, 1e-5)
    clean = Mechanism(curve, pieces, gain, offset).respond(motion)[0]
    rng = np.random.default_rng(seed)
    n = len(motion)
    samples = pd.DataFrame(
        {
            "time_s": motion.time_s,
            "cycle": motion.cycle,
            "step": np.arange(n) % STEPS,
            "pitch_command_deg": motion.drive,
            "yaw_command_deg": motion.others["yaw_command_deg"],
            "pitch_angle_deg": clean + noise * rng.standard_normal(n),
            "pitch_angle_sim_deg": curve(motion.drive),
        }
    )
    return Recording(samples, CHANNELS, "simulated")


def explained(recording: Recording) -> Explanation:
    """What explains the angle of such a recording."""
    simulated = recording.values("pitch_angle_sim_deg")
    return explain(pose_problem(DiagnosisConfig(), recording, "pitch_angle_deg", simulated))

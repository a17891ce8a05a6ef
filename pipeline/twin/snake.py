"""The simulated snake: two joints, each a mechanism of physics terms, moved by motor shafts."""

import math
import threading
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from pipeline.config import AxisTwin, TwinConfig
from pipeline.physics.assembly import pieces_of
from pipeline.physics.kinematics import CubicCurve
from pipeline.physics.mechanism import Mechanism, State
from pipeline.physics.motion import Motion
from pipeline.physics.noise import pose_noise
from pipeline.physics.term import Surroundings

AXES = ("yaw", "pitch")


@dataclass(frozen=True)
class AxisPhysics:
    """What moves a joint, and what its camera makes of the pose."""

    body: Mechanism
    sensor: Mechanism


def physics_of(axis: str, config: AxisTwin) -> AxisPhysics:
    """Nominal curve, play and the further terms of one axis (angles and shafts in deg).

    Raises TermError for a term or parameter that physics does not have.
    """
    others = [f"{other}_command_deg" for other in AXES if other != axis]
    around = Surroundings(other_span=dict.fromkeys(others, Surroundings().drive_span))
    named = {"backlash": {"width": 2.0 * config.play_half_width_deg}} | dict(config.terms)
    pieces = pieces_of(named, around)
    return AxisPhysics(
        Mechanism(
            CubicCurve(config.gain, config.cubic),
            [piece for piece in pieces if piece.term.site != "sensor"],
        ),
        Mechanism(pieces=[piece for piece in pieces if piece.term.site == "sensor"]),
    )


class Snake:
    """Two joints that follow two shafts.

    The pose noise is the robot's own: a joint settles a little beside where its mechanism puts
    it, anew each time a shaft has moved, and stays there until one moves again. The snake may be
    moved and looked at from different threads.
    """

    def __init__(self, config: TwinConfig, seed: int) -> None:
        rng = np.random.default_rng(seed)
        self._joints = {axis: _Joint(axis, getattr(config, axis), rng) for axis in AXES}
        self._time_s = math.nan
        self._shaft_deg: dict[str, float] = {}
        self._lock = threading.Lock()
        self.move(0.0, dict.fromkeys(AXES, 0.0))

    def move(self, time_s: float, shaft_deg: Mapping[str, float]) -> None:
        """Both shafts stand at these angles at `time_s`, having gone there without a turn."""
        with self._lock:
            standing = {axis: float(shaft_deg[axis]) for axis in AXES}
            moved = standing != self._shaft_deg
            if not moved and time_s == self._time_s:
                return
            self._time_s, self._shaft_deg = time_s, standing
            for axis, joint in self._joints.items():
                others = {f"{a}_command_deg": v for a, v in standing.items() if a != axis}
                joint.follow(time_s, standing[axis], others, settle=moved)

    def pose_deg(self) -> dict[str, float]:
        """The true bending angle of each axis, noise included."""
        with self._lock:
            return {axis: joint.pose_deg for axis, joint in self._joints.items()}

    def seen_deg(self) -> dict[str, float]:
        """The bending angle that the picture of each axis shows: its pose, but for sensor terms."""
        with self._lock:
            return {axis: joint.seen_deg for axis, joint in self._joints.items()}


class _Joint:
    def __init__(self, axis: str, config: AxisTwin, rng: np.random.Generator) -> None:
        self._physics = physics_of(axis, config)
        self._noise_deg = config.noise_deg
        self._rng = rng
        self._body: State | None = None
        self._sensor: State | None = None
        self._shaft_deg = 0.0
        self._cycle = 0
        self._beside_deg = 0.0
        self.pose_deg = 0.0
        self.seen_deg = 0.0

    def follow(
        self, time_s: float, shaft_deg: float, others: Mapping[str, float], settle: bool
    ) -> None:
        """Go where the shaft is; a cycle ends where it rises through home."""
        self._cycle += self._shaft_deg < 0.0 <= shaft_deg
        self._shaft_deg = shaft_deg
        motion = Motion(
            drive=np.array([shaft_deg]),
            time_s=np.array([time_s]),
            cycle=np.array([self._cycle]),
            others={name: np.array([value]) for name, value in others.items()},
        )
        angle_deg, self._body = self._physics.body.respond(motion, self._body)
        if settle:
            self._beside_deg = float(pose_noise(self._noise_deg, 1, self._rng)[0])
        pose_deg = angle_deg + self._beside_deg
        seen_deg, self._sensor = self._physics.sensor.respond(
            replace(motion, drive=pose_deg), self._sensor
        )
        self.pose_deg, self.seen_deg = float(pose_deg[0]), float(seen_deg[0])

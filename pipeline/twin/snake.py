"""The simulated snake: two joints, each a mechanism of physics terms, moved by motor shafts."""

import threading
from collections.abc import Mapping

import numpy as np

from pipeline.config import AxisTwin, TwinConfig
from pipeline.physics.catalogue import term
from pipeline.physics.kinematics import CubicCurve
from pipeline.physics.mechanism import Mechanism, Piece, State
from pipeline.physics.motion import Motion
from pipeline.physics.noise import pose_noise
from pipeline.physics.term import Surroundings, values_of

AXES = ("yaw", "pitch")


def mechanism_of(config: AxisTwin) -> Mechanism:
    """Nominal curve, play and the further terms of one axis (angles and shaft in deg).

    Raises TermError for a term or parameter that physics does not have.
    """
    named = {"backlash": {"width": 2.0 * config.play_half_width_deg}} | dict(config.terms)
    around = Surroundings()
    pieces = [
        Piece(physics, values_of(physics, around, parameters))
        for physics, parameters in ((term(name), given) for name, given in named.items())
    ]
    return Mechanism(CubicCurve(config.gain, config.cubic), pieces)


class Snake:
    """Two joints that follow two shafts.

    The pose noise is the robot's own: a joint settles a little beside where its mechanism puts
    it, anew each time a shaft has moved, and stays there until one moves again. The snake may be
    moved and looked at from different threads.
    """

    def __init__(self, config: TwinConfig, seed: int) -> None:
        rng = np.random.default_rng(seed)
        self._joints = {axis: _Joint(getattr(config, axis), rng) for axis in AXES}
        self._shaft_deg: dict[str, float] = {}
        self._lock = threading.Lock()
        self.move(0.0, dict.fromkeys(AXES, 0.0))

    def move(self, time_s: float, shaft_deg: Mapping[str, float]) -> None:
        """Both shafts stand at these angles at `time_s`, having gone there without a turn."""
        with self._lock:
            standing = {axis: float(shaft_deg[axis]) for axis in AXES}
            moved = standing != self._shaft_deg
            self._shaft_deg = standing
            for axis, joint in self._joints.items():
                others = {f"{a}_command_deg": v for a, v in standing.items() if a != axis}
                joint.follow(time_s, standing[axis], others)
                if moved:
                    joint.settle()

    def pose_deg(self) -> dict[str, float]:
        """The true bending angle of each axis, noise included."""
        with self._lock:
            return {axis: joint.pose_deg for axis, joint in self._joints.items()}


class _Joint:
    def __init__(self, config: AxisTwin, rng: np.random.Generator) -> None:
        self._mechanism = mechanism_of(config)
        self._noise_deg = config.noise_deg
        self._rng = rng
        self._state: State | None = None
        self._shaft_deg = 0.0
        self._cycle = 0
        self._angle_deg = 0.0
        self._beside_deg = 0.0

    def follow(self, time_s: float, shaft_deg: float, others: Mapping[str, float]) -> None:
        """Take the mechanism to the shaft's angle; a cycle ends where it rises through home."""
        self._cycle += self._shaft_deg < 0.0 <= shaft_deg
        self._shaft_deg = shaft_deg
        motion = Motion(
            drive=np.array([shaft_deg]),
            time_s=np.array([time_s]),
            cycle=np.array([self._cycle]),
            others={name: np.array([value]) for name, value in others.items()},
        )
        angle_deg, self._state = self._mechanism.respond(motion, self._state)
        self._angle_deg = float(angle_deg[0])

    def settle(self) -> None:
        """Draw how far beside its place the joint comes to rest."""
        self._beside_deg = float(pose_noise(self._noise_deg, 1, self._rng)[0])

    @property
    def pose_deg(self) -> float:
        return self._angle_deg + self._beside_deg

"""Viscous friction: a force against the motion that grows with its speed."""

from typing import ClassVar

import numpy as np
from numba import njit

from pipeline.physics.decay import decayed
from pipeline.physics.force_term import ASYMMETRY, ForceTerm, both_ways, per, size
from pipeline.physics.motion import Kinetics, Motion
from pipeline.physics.pre_sliding import weighted
from pipeline.physics.term import Parameter, Surroundings

SHARES = (0.01, 0.03, 0.1, 0.3)


def relaxation_of(around: Surroundings) -> Parameter:
    """The time in which a damper lets go of the spring that it stands behind."""
    sample_s = max(around.dwell_s, 1e-9)
    longest_s = max(around.end_s - around.start_s, sample_s)
    return Parameter("relaxation", "s", 0.2 * sample_s, longest_s, 0.1 * around.period_s, 0.0,
                     relative=True)  # fmt: skip


class ViscousFriction(ForceTerm):
    """F = damping * v.

    Form "asymmetric" differs for the two directions: damping * v (1 + asymmetry sgn v). Form
    "sprung" has a spring of damping / relaxation in series: F + relaxation F' = damping * v, as oil
    that gives, a soft mount, rubber. Source: Stokes (1851); one coefficient for each direction as
    in Hamon, Gautier and Garrec, IROS 2010; Maxwell, Phil. Trans. 157 (1867) 49 (sprung).
    """

    name = "viscous_friction"
    directed = True
    grows: ClassVar = {"": ("asymmetric",)}
    says = "Friction that grows with the speed holds back by {damping}."

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        most = 4.0 * around.angle_span / max(around.top_speed, 1e-12)
        own = size("damping", per(around, 1), most, around)
        if self.form == "sprung":
            return (own, relaxation_of(around))
        return (own, ASYMMETRY) if self.form == "asymmetric" else (own,)

    def force(
        self, motion: Motion, kinetics: Kinetics, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray | None]:
        if self.form == "sprung":
            pulled, after = _sprung(motion.drive, motion.time_s, float(values[1]), state)
            return values[0] * pulled, after
        asymmetry = float(values[1]) if len(values) > 1 else 0.0
        return values[0] * weighted(kinetics.velocity, asymmetry), state

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        found = super().candidates(motion, around)
        if self.form == "sprung":
            found = np.repeat(found, len(SHARES), axis=0)
            found[:, 1] = np.array(SHARES) * around.period_s
        return found

    def sentence(self, values: np.ndarray, around: Surroundings) -> str:
        told = "Friction that grows with the speed holds back by"
        if self.form == "sprung":
            size = both_ways(float(values[0]), 0.0, per(around, 1))
            return f"{told} {size} behind a spring that it lets go of in {values[1]:.3g} s."
        asymmetry = float(values[1]) if len(values) > 1 else 0.0
        return f"{told} {both_ways(float(values[0]), asymmetry, per(around, 1))}."


def _sprung(
    position: np.ndarray, time_s: np.ndarray, relaxation_s: float, state: np.ndarray | None
) -> tuple[np.ndarray, np.ndarray]:
    """The speed that a damper behind a spring resists, (n,), and the state to carry.

    It begins unstressed; exact where the position moves evenly from sample to sample.
    """
    begun = np.array([position[0], time_s[0], 0.0]) if state is None else state
    out = _followed(np.ascontiguousarray(position), time_s, relaxation_s, *begun)
    return out, np.array([position[-1], time_s[-1], out[-1]])


@njit(cache=True, error_model="numpy")
def _followed(position, time_s, relaxation_s, at, then_s, speed):  # type: ignore[no-untyped-def]
    out = np.empty(position.size)
    for i in range(position.size):
        past_s = time_s[i] - then_s
        if past_s > 0.0:
            left = decayed(past_s / relaxation_s)
            speed = left * speed + (1.0 - left) * (position[i] - at) / past_s
        at, then_s = position[i], time_s[i]
        out[i] = speed
    return out

"""Stribeck friction: friction that falls when motion sets in."""

from typing import ClassVar

import numpy as np

from pipeline.physics.coulomb_friction import ONSETS, onset_of, reach_of
from pipeline.physics.force_term import ASYMMETRY, ForceTerm
from pipeline.physics.motion import Kinetics, Motion
from pipeline.physics.pre_sliding import lagging, weighted
from pipeline.physics.term import Parameter, Surroundings

SPEEDS = (0.02, 0.07, 0.2)
REACHES = (3e-4, 0.01)


class StribeckFriction(ForceTerm):
    """F = force * y: what a slow contact holds beyond a fast one, y = exp(-(v / speed)^2) sgn v.

    y comes there over the pre-sliding travel, as in the LuGre model (`pre_sliding.lagging`). Form
    "asymmetric": force (1 + asymmetry) rising, (1 - asymmetry) falling; form "smoothed": y =
    tanh(v / onset) exp(-(v / speed)^2), without pre-sliding; "tustin" and "smoothed tustin": with
    exp(-|v| / speed). Source: Stribeck (1902); Tustin (1947); Armstrong-Helouvry, Dupont and
    Canudas de Wit, Automatica 30 (1994) 1083.
    """

    name = "stribeck_friction"
    place = 130.0
    remembers = "way"
    directed = True
    grows: ClassVar = {"": ("asymmetric", "smoothed")}
    means = "friction that falls when motion sets in"
    says = "At less than about {speed}, dry friction holds back by {force} more."

    @property
    def smoothed(self) -> bool:
        """Whether it turns round with the speed, without pre-sliding."""
        return self.form.startswith("smoothed")

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        span = around.angle_span
        top = max(around.top_speed, 1e-12)
        unit = f"{around.drive_unit}/s"
        own = (
            Parameter("force", around.angle_unit, 0.0, 2.0 * span, 0.05 * span, 0.1 * span),
            Parameter("speed", unit, 1e-3 * top, 0.3 * top, 0.1 * top, 0.0, relative=True),
            onset_of(around) if self.smoothed else reach_of(around),
        )
        return (*own, ASYMMETRY) if self.form == "asymmetric" else own

    def force(
        self, motion: Motion, kinetics: Kinetics, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray | None]:
        fast = np.abs(kinetics.velocity / values[1])
        fallen = np.exp(-fast if self.form.endswith("tustin") else -(fast**2))
        if self.smoothed:
            return values[0] * np.tanh(kinetics.velocity / values[2]) * fallen, None
        way, rows = motion.way
        slow = np.ones(len(way))
        slow[rows] = fallen
        share, state = lagging(way, slow, float(values[2]), state)
        asymmetry = float(values[3]) if len(values) > 3 else 0.0
        return values[0] * weighted(share[rows], asymmetry), state

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        own = [p.start for p in self.parameters(around)]
        turns = [r * around.drive_span for r in REACHES]
        if self.smoothed:
            turns = [o * max(around.top_speed, 1e-12) for o in ONSETS]
        speeds = [s * around.top_speed for s in SPEEDS]
        return np.array([[own[0], speed, t, *own[3:]] for speed in speeds for t in turns])

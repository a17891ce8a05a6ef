"""Coulomb friction: a force against the motion, whatever its speed."""

from typing import ClassVar

import numpy as np

from pipeline.number_words import worded
from pipeline.physics.force_term import ASYMMETRY, ForceTerm, both_ways, resistance
from pipeline.physics.motion import Kinetics, Motion
from pipeline.physics.pre_sliding import dragging, sliding, weighted
from pipeline.physics.term import Parameter, Surroundings

LEAST_REACH = 1e-6
REACHES = (5e-6, 5e-5, 3e-4, 2e-3, 0.01, 0.03, 0.1, 0.3)
ONSETS = (1e-3, 4e-3, 0.015, 0.06)
SHAPES = {
    "spread": Parameter("spread", "", 0.0, 1.0, 0.7, 0.0),
    "bristle": Parameter("release", "", 0.0, 1.0, 0.7, 0.0),
}


def reach_of(around: Surroundings) -> Parameter:
    """The travel over which a dry contact turns round."""
    span = max(around.drive_span, 1e-12)
    return Parameter("reach", around.drive_unit, LEAST_REACH * span, 2.0 * span, 2e-3 * span, 0.0,
                     relative=True)  # fmt: skip


def onset_of(around: Surroundings) -> Parameter:
    """The speed from which on a dry contact without pre-sliding resists in full."""
    top = max(around.top_speed, 1e-12)
    return Parameter("onset", f"{around.drive_unit}/s", 1e-5 * top, 0.5 * top, 0.01 * top, 0.0,
                     relative=True)  # fmt: skip


class CoulombFriction(ForceTerm):
    """F = force * z, where z goes from -1 to 1 over the pre-sliding travel (`pre_sliding.py`).

    Forms: "" turns round about as Dahl's curve does (spread 1); "asymmetric" with force (1 +
    asymmetry) rising and (1 - asymmetry) falling; "spread" with the shape of the turn free;
    "bristle" is one that Dahl, or Bouc and Wen, let go (see `bristled`); "asymmetric spread" and
    "asymmetric bristle" with both. In "smoothed" and "smoothed asymmetric" z = tanh(v / onset): no
    pre-sliding, but resistance that grows with the speed until it is full. Source: Coulomb (1785);
    Dahl, AIAA J. 14 (1976) 1675, and `pre_sliding.py`; Andersson, Soderberg and Bjorklund, Tribol.
    Int. 40 (2007) 580 (smoothed).
    """

    name = "coulomb_friction"
    place = 110.0
    remembers = "way"
    directed = True
    grows: ClassVar = {
        "": ("asymmetric", "spread", "bristle", "smoothed"),
        "smoothed": ("smoothed asymmetric",),
        "asymmetric": ("asymmetric spread", "asymmetric bristle"),
        "bristle": ("asymmetric bristle", "spread"),
        "asymmetric spread": ("asymmetric bristle",),
        "spread": ("asymmetric spread", "bristle"),
    }
    means = "a force against the motion, whatever its speed"
    says = "Dry friction holds back by {force} at any speed, and turns round over {reach}."

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        turn = onset_of(around) if "smoothed" in self.form else reach_of(around)
        own = (resistance("force", around.angle_unit, 2.0 * around.angle_span, around), turn)
        asymmetry = (ASYMMETRY,) if "asymmetric" in self.form else ()
        shape = [SHAPES[word] for word in self.form.split() if word in SHAPES]
        return (*own, *asymmetry, *shape)

    def force(
        self, motion: Motion, kinetics: Kinetics, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray | None]:
        asymmetry = float(values[2]) if "asymmetric" in self.form else 0.0
        if "smoothed" in self.form:
            return values[0] * weighted(np.tanh(kinetics.velocity / values[1]), asymmetry), None
        if "bristle" in self.form:
            share, state = dragging(motion.drive, float(values[1]), float(values[-1]), state)
        else:
            spread = float(values[-1]) if "spread" in self.form else 1.0
            share, state = sliding(motion.drive, float(values[1]), spread, state)
        return values[0] * weighted(share, asymmetry), state

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        own = [p.start for p in self.parameters(around)]
        turns = [r * around.drive_span for r in REACHES]
        if "smoothed" in self.form:
            turns = [o * max(around.top_speed, 1e-12) for o in ONSETS]
        return np.array([[own[0], turn, *own[2:]] for turn in turns])

    def sentence(self, values: np.ndarray, around: Surroundings) -> str:
        asymmetry = float(values[2]) if "asymmetric" in self.form else 0.0
        ways = both_ways(float(values[0]), asymmetry, around.angle_unit)
        reach = f"{worded(values[1])} {around.drive_unit}"
        if "smoothed" in self.form:
            return f"Dry friction holds back by {ways} at any speed beyond about {reach}/s."
        return f"Dry friction holds back by {ways} at any speed, and turns round over {reach}."

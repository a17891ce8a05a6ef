"""Coulomb friction: a force against the motion, whatever its speed."""

from itertools import product
from typing import ClassVar

import numpy as np

from pipeline.number_words import worded
from pipeline.physics.bent_bristle import bending
from pipeline.physics.damped_sliding import yielding
from pipeline.physics.force_term import ASYMMETRY, ForceTerm, both_ways, per, resistance
from pipeline.physics.motion import Kinetics, Motion
from pipeline.physics.pre_sliding import (
    FASTEST,
    FINELY,
    WIDEST,
    dragging,
    evenly,
    sliding,
    slipped,
    weighted,
)
from pipeline.physics.sprung_sliding import giving_way
from pipeline.physics.term import Parameter, Surroundings

LEAST_REACH = 1e-6
REACHES = (5e-6, 5e-5, 3e-4, 2e-3, 0.01, 0.03, 0.1, 0.3)
DRY, YIELDING = 0.25, 1.0
ONSETS = (1e-3, 4e-3, 0.015, 0.06)
DASHPOTS = (0.015, 0.06, 0.2, 0.5)
SPREAD, EVEN_SPREAD = (Parameter("spread", "", 0.0, most, 0.7, 0.0) for most in (WIDEST, 1.0))
SHAPES = (
    Parameter("release", "", 0.0, FASTEST, 0.7, 0.0),
    Parameter("curve", "", 0.3, 5.0, 1.5, 0.0),
)
SHAPE_OF = {"spread": "spread", "even": "spread", "bristle": "release", "bent": "curve"}
CURVES = (0.5, 1.0, 2.0)
MIDDLES = (0.0, 0.5, 1.0)
GROWN = (-0.5, 0.5)
LEAST_PRESSED = 0.2
SEEN = 0.02  # of the drive's range: over so much, a turn is seen to be gradual


def reach_of(around: Surroundings) -> Parameter:
    """The travel over which a dry contact turns round."""
    span = max(around.drive_span, 1e-12)
    return Parameter("reach", around.drive_unit, LEAST_REACH * span, 2.0 * span, 2e-3 * span, 0.0,
                     relative=True)  # fmt: skip


def onset_of(around: Surroundings, most: float = DRY) -> Parameter:
    """The speed from which on a dry contact without pre-sliding resists in full.

    most: share of the top speed that it may be: what goes on growing far beyond is no dry contact.
    """
    top = max(around.top_speed, 1e-12)
    return Parameter("onset", f"{around.drive_unit}/s", 1e-5 * top, most * top, 0.01 * top, 0.0,
                     relative=True)  # fmt: skip


def load_of(around: Surroundings) -> tuple[Parameter, Parameter]:
    """How much more a contact is pressed by the way from where it is pressed as told."""
    span, per_way = max(around.drive_span, 1e-12), per(around, 0)
    most = 4.0 * around.angle_span / span
    return (
        Parameter("growth", per_way, -most, most, 0.0, 0.2 * around.angle_span / span),
        Parameter("middle", around.drive_unit, around.drive_low, around.drive_low + span,
                  around.drive_low + 0.5 * span, 0.0),
    )  # fmt: skip


class CoulombFriction(ForceTerm):
    """F = force * z, where z goes from -1 to 1 over the pre-sliding travel (`pre_sliding.py`).

    Forms: "" turns round about as Dahl's curve does (spread 1); "asymmetric" with force (1 +
    asymmetry) rising and (1 - asymmetry) falling; "spread" with the shape of the turn free;
    "even" one of elements whose reaches lie evenly about their mean, as Iwan's first;
    "bristle" is one that Dahl, or Bouc and Wen, let go (see `bristled`), "bristle bent" with the
    exponent of either (see `bending`). In "smoothed" z = tanh(v / onset): no pre-sliding, but
    resistance that grows with the speed until it is full; "smoothed sprung" is that behind a spring
    (see `giving_way`), "smoothed dashpot" a bristle behind a dashpot (see `yielding`). In the
    "loaded" forms force + growth |x - middle| takes the place of force, as where a wedge or a
    spring presses the contact; with its middle at an end of the way it grows, or falls, all along.
    Each of them also "asymmetric". Source: Coulomb (1785); Dahl, AIAA J. 14 (1976) 1675, and
    `pre_sliding.py`; Andersson, Soderberg and Bjorklund, Tribol. Int. 40 (2007) 580 (smoothed);
    Nims, Richter and Bachman, Earthq. Spectra 9 (1993) 467 (loaded).
    """

    name = "coulomb_friction"
    place = 110.0
    remembers = "way"
    directed = True
    grows: ClassVar = {
        "": ("asymmetric", "spread", "bristle", "smoothed"),
        "smoothed": ("smoothed asymmetric",),
        "smoothed sprung": ("asymmetric smoothed sprung",),
        "smoothed dashpot": ("asymmetric smoothed dashpot",),
        "asymmetric": ("asymmetric spread", "asymmetric bristle"),
        "bristle": ("asymmetric bristle", "spread"),
        "asymmetric spread": ("asymmetric bristle", "asymmetric even"),
        "spread": ("asymmetric spread", "bristle", "even"),
        "even": ("asymmetric even",),
        "bristle bent": ("asymmetric bristle bent", "bristle bent loaded", "even"),
        "asymmetric bristle bent": ("asymmetric even",),
        "bristle bent loaded": ("asymmetric bristle bent loaded",),
        "loaded": ("asymmetric loaded", "spread loaded"),
        "spread loaded": ("asymmetric spread loaded",),
    }
    means = "a force against the motion, whatever its speed"
    says = "Dry friction holds back by {force} at any speed, and turns round over {reach}."

    def __init__(self, form: str = "") -> None:
        self.form = form
        words = form.split()
        gives = "sprung" in words or "dashpot" in words
        own = ("onset", "reach") if gives else ("onset",)
        shapes = [name for word, name in SHAPE_OF.items() if word in words]
        self._names = (
            "force",
            *(own if "smoothed" in words else ("reach",)),
            *(("asymmetry",) if "asymmetric" in words else ()),
            *shapes,
            *(("growth", "middle") if "loaded" in words else ()),
        )

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        force = resistance("force", around.angle_unit, 2.0 * around.angle_span, around)
        onset = onset_of(around, YIELDING if "dashpot" in self.form else DRY)
        spread = EVEN_SPREAD if "even" in self.form else SPREAD
        every = (force, onset, reach_of(around), ASYMMETRY, spread, *SHAPES, *load_of(around))
        return tuple(p for p in every if p.name in self._names)

    def sizes(self, values: np.ndarray) -> dict[str, float]:
        """Its parameters by name, none of asymmetry and growth where it has none."""
        named = dict(zip(self._names, (float(v) for v in values), strict=True))
        return {"asymmetry": 0.0, "growth": 0.0, "middle": 0.0, **named}

    def force(
        self, motion: Motion, kinetics: Kinetics, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray | None]:
        own = self.sizes(values)
        if self.form in ("smoothed", "smoothed asymmetric"):
            share = np.tanh(kinetics.velocity / own["onset"])
            return own["force"] * weighted(share, own["asymmetry"]), None
        if "onset" in own:
            answer = yielding if "dashpot" in self.form else giving_way
            share, state = answer(
                kinetics.velocity, motion.time_s, own["onset"], own["reach"], state
            )
            return own["force"] * weighted(share, own["asymmetry"]), state
        share, state = self.turning(motion.way[0], own, state)
        share = weighted(share[motion.way[1]], own["asymmetry"])
        if own["growth"] == 0.0:
            return own["force"] * share, state
        pressed = own["force"] + own["growth"] * np.abs(motion.drive - own["middle"])
        return np.maximum(pressed, 0.0) * share, state

    def turning(
        self, way: np.ndarray, own: dict[str, float], state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        """The share of the friction that acts all along a way (m,), and the state to carry."""
        if "bent" in self.form:
            return bending(way, own["reach"], own["release"], own["curve"], state)
        if "bristle" in self.form:
            return dragging(way, own["reach"], own["release"], state)
        if "even" in self.form:
            return slipped(way, evenly(own["reach"], own["spread"]), state)
        return sliding(way, own["reach"], own.get("spread", 1.0), state, FINELY)

    def scaled(self, values: np.ndarray, factor: float) -> np.ndarray:
        out = super().scaled(values, factor)
        if "growth" in self._names:
            out[self._names.index("growth")] *= factor
        return out

    def void(self, values: np.ndarray) -> bool:
        own = self.sizes(values)
        return own["force"] == 0.0 and own["growth"] == 0.0

    def slight(self, values: np.ndarray, around: Surroundings) -> bool:
        """Pressed by less than a fifth more at its farther end: any friction differs so."""
        own = self.sizes(values)
        half = 0.5 * around.drive_span
        far = half + abs(own["middle"] - around.drive_low - half)
        return "growth" in self._names and abs(own["growth"]) * far < LEAST_PRESSED * own["force"]

    def other_names(self, values: np.ndarray, around: Surroundings) -> tuple[str, ...]:
        """Friction, as it is called where a displacement is measured, where pre-sliding is seen."""
        seen = self.sizes(values).get("reach", 0.0) > SEEN * around.drive_span
        return ("friction",) if seen else ()

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        start = {p.name: p.start for p in self.parameters(around)}
        top, span = max(around.top_speed, 1e-12), max(around.drive_span, 1e-12)
        grids = {
            "onset": top * np.array(DASHPOTS if "dashpot" in self.form else ONSETS),
            "reach": around.drive_span * np.array(REACHES),
            "curve": np.array(CURVES),
            "growth": start["force"] / span * np.array(GROWN),
            "middle": around.drive_low + around.drive_span * np.array(MIDDLES),
        }
        axes = [grids[name] if name in grids else [start[name]] for name in self._names]
        return np.array(list(product(*axes)))

    def sentence(self, values: np.ndarray, around: Surroundings) -> str:
        own, unit = self.sizes(values), around.drive_unit
        ways = both_ways(own["force"], own["asymmetry"], around.angle_unit)
        if "onset" in own:
            told = f"Dry friction holds back by {ways} at any speed beyond about "
            told += f"{worded(own['onset'])} {unit}/s"
            if "reach" in own:
                told += f", and gives by {worded(own['reach'])} {unit} before it slides"
            return f"{told}."
        turns = f"turns round over {worded(own['reach'])} {unit}"
        if own["growth"] == 0.0:
            return f"Dry friction holds back by {ways} at any speed, and {turns}."
        grown = "more" if own["growth"] > 0.0 else "less"
        return (
            f"Dry friction holds back by {ways} at {worded(own['middle'])} {unit}, by "
            f"{worded(abs(own['growth']))} {per(around, 0)} {grown} away from there, at any speed, "
            f"and {turns}."
        )

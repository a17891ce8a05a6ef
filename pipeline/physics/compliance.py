"""Compliance: the wire stretches, which lowers the gain and hardens."""

from typing import ClassVar

import numpy as np

from pipeline.physics.balance import Load
from pipeline.physics.motion import Motion
from pipeline.physics.term import NO_STATE, Parameter, Shown, Surroundings, Term

DRIVEN, PROGRESSIVE, SIDES = "driven", "progressive", ("upper", "lower")


class Compliance(Term):
    """Stretch of the wire under the joint's own stiffness, in the balance.

    stretch * theta, and besides, in form "wire", softness * reach * (1 - exp(-|theta| / reach)) of
    a free joint: a wire that is soft while it is loose and hardens with its force; `stiffness` is
    the joint's over the wire's. In form "toe" the wire hardens with its own stretch e instead, as
    ropes do: it pulls by e - toe * length * (1 - exp(-e / length)). Its parameters mean the same:
    softness at first, and the reach within which half of that is gone. In form "off home" the wire
    is loose at theta = centre, where the joint's own spring is at rest. Form "joint": hardening *
    theta^3. Form "progressive": rise * theta * |theta|, a joint that stiffens in proportion to its
    bend, rounded within `onset` of the middle. Forms "upper" and "lower": softness * width * log(1
    + exp(+-(theta - centre) / width)), the wire that pulls to that side is the softer one, and
    takes over from the other over a `width`. Form "driven" is stretch before the nominal curve,
    that of a drive u off its centre: softness u / (1 + |u / reach|^a)^(1 / a), the sooner gone at
    the reach the larger the `abruptness` a; a wire that loses more than half of the way hangs
    slack. Source: two springs in series; toe region of wire ropes, Feyrer, Wire Ropes (2015),
    section 2.3; of tendons, Fung, Biomechanics (1993), section 7.3; Duffing; springs of progressive
    rate, Wahl, Mechanical Springs (1963); Richard and Abbott, J. Eng. Mech. Div. ASCE 101 (1975)
    511.
    """

    name = "compliance"
    site = "transmission"
    in_balance = True
    group = "bend"
    grows: ClassVar = {"wire": ("toe", "off home", DRIVEN), "joint": (PROGRESSIVE,)}
    means = "stretch: less motion than commanded, hardening"
    says = (
        "The wire stretches under the joint's stiffness, and hardens: it moves less than commanded."
    )

    def __init__(self, form: str = "wire") -> None:
        self.form = form
        self.before_curve = form == DRIVEN
        self.in_balance = not self.before_curve
        self.own_law = form in ("toe", OFF_HOME)

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        half, unit = 0.5 * around.angle_span, around.angle_unit
        stretch = Parameter("stretch", "", 0.0, 2.0, 0.02, 0.1, weak=True)
        if self.form == "joint":
            hard = 0.1 / half**2
            return (Parameter("hardening", f"1/{unit}^2", 0.0, 30 * hard, hard, hard), stretch)
        if self.form == PROGRESSIVE:
            rise, edge = 0.1 / half, 0.05 * half
            onset = Parameter("onset", unit, 0.2 * edge, 20.0 * edge, edge, 0.0, weak=True)
            return (Parameter("rise", f"1/{unit}", 0.0, 30 * rise, rise, rise), stretch, onset)
        if self.form in SIDES:
            middle, far = around.angle_low + half, 0.7 * half
            return (
                Parameter("softness", "", 0.0, 2.0, 0.2, 0.2),
                Parameter("centre", unit, middle - far, middle + far, middle, 0.1 * half),
                Parameter("width", unit, GRADUAL * half, half, 0.2 * half, 0.0),
            )
        if self.form == DRIVEN:
            far, unit = 0.5 * around.drive_span, around.drive_unit
            low, high = min(around.drive_low, 0.0), max(around.drive_low + 2.0 * far, 0.0)
            return (
                Parameter("softness", "", 0.0, 0.5, 0.2, 0.2),
                Parameter("reach", unit, 0.02 * far, 4.0 * far, 0.4 * far, 0.4 * far),
                Parameter("abruptness", "", 0.4, 8.0, 2.0, 0.0),
                Parameter("centre", unit, low, high, 0.0, 0.1 * far, weak=True),
            )
        wire = (
            Parameter("softness", "", 0.0, 0.8, 0.2, 0.2),
            Parameter("reach", unit, 0.01 * half, 2.0 * half, 0.2 * half, 0.2 * half),
            stretch,
            Parameter("stiffness", "", 0.002, 2.0, 0.2, 0.05, weak=True),
        )
        if self.form != OFF_HOME:
            return wire
        middle, far = around.angle_low + half, 0.7 * half
        return (
            *wire,
            Parameter("centre", unit, middle - far, middle + far, middle, 0.1 * half),
        )

    def void(self, values: np.ndarray) -> bool:
        if self.form in (DRIVEN, *SIDES):
            return super().void(values)
        stretch = values[1] if self.form in ("joint", PROGRESSIVE) else values[2]
        return bool(values[0] == 0.0 and stretch == 0.0)

    def load(self, values: np.ndarray, motion: Motion, state: np.ndarray | None) -> Load:
        if self.form == "joint":
            return Load(smooth=(float(values[1]), float(values[0]), 0.0, 0.0))
        if self.form == PROGRESSIVE:
            rise, stretch, onset = values
            sides = np.array([[1.0], [-1.0]])
            contact = sides * [1.0 / onset, 0.0, 0.0, rise * onset**2]
            return Load(contact=contact, smooth=(float(stretch), 0.0, 0.0, 0.0))
        if self.form in SIDES:
            (softness, middle, width), side = values, 1.0 if self.form == SIDES[0] else -1.0
            return Load(
                contact=side * np.array([[1.0 / width, side * middle, softness * width, 0.0]])
            )
        softness, reach, stretch, stiffness, *centre = values
        if self.form == "toe":
            toe = softness / (softness + stiffness)
            half_gone = np.log(2.0 - toe) - toe * (1.0 - toe) / (2.0 - toe)
            length = stiffness * reach * np.log(2.0) / half_gone
            own = stiffness - stretch
            return Load(toe=(float(own), float(stiffness), float(toe), float(length)))
        most, sharpness = softness * reach, 1.0 / (stiffness * reach)
        return Load(
            smooth=(float(stretch), 0.0, 0.0, 0.0),
            give=np.array([[most, sharpness, stiffness, *(centre or [0.0])]]),
        )

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        softness, reach, abruptness, centre = values
        off = signal - centre
        stretch = softness * off / (1.0 + np.abs(off / reach) ** abruptness) ** (1.0 / abruptness)
        return signal - stretch, NO_STATE

    def plainer(self, values: np.ndarray, shown: Shown) -> str:
        """Wire that gives way within less than a step and no more hung slack.

        But not a toe, which hardens on the way.
        """
        if self.form not in ("wire", OFF_HOME):
            return self.name
        reach, stretch, stiffness = values[1:4]
        return "slack" if reach * stiffness / (stiffness + stretch) < shown.step else self.name

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        half = 0.5 * around.angle_span
        if self.form == "joint":
            return np.array([[h / half**2, s] for h in (0.03, 0.3) for s in (0.0, 0.2)])
        if self.form == PROGRESSIVE:
            return np.array([[rise / half, 0.0, 0.05 * half] for rise in (0.03, 0.1, 0.3)])
        if self.form in SIDES:
            middle = around.angle_low + half
            return np.array([[0.2, middle + c * half, 0.2 * half] for c in (-0.3, 0.0, 0.3)])
        if self.form == DRIVEN:
            far = 0.5 * around.drive_span
            return np.array([[0.2, r * far, a, 0.0] for r in (0.25, 0.7) for a in (1.0, 2.0, 4.0)])
        if self.form == "toe":
            starts = ((0.4, 0.1, 0.2), (0.2, 0.2, 0.2), (0.2, 0.4, 0.2), (0.2, 0.2, 0.1))
            return np.array([[s, r * half, 0.0, k] for s, r, k in starts])
        reaches = (0.05, 0.12, 0.25, 0.5) if self.form == "wire" else (0.1, 0.3)
        wire = [[0.1, r * half, 0.0, 0.1] for r in reaches]
        if self.form == "wire":
            return np.array(wire)
        middle = around.angle_low + half
        return np.array([[*w, middle + c * half] for w in wire for c in (-0.3, -0.1, 0.1, 0.3)])


OFF_HOME = "off home"
GRADUAL = 0.12

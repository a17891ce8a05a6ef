"""A soft wire: it stretches under the joint's own stiffness, and hardens."""

from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from pipeline.physics.balance import Load
from pipeline.physics.compliance import STRETCH, Compliance, centre, centres
from pipeline.physics.driven_slack import driven_as
from pipeline.physics.driven_stretch import SOON, DrivenStretch
from pipeline.physics.motion import Motion
from pipeline.physics.term import Parameter, Shown, Surroundings, Term, Told

OFF_HOME = "off home"


class SoftWire(Compliance):
    """Stretch of the wire under the joint's own stiffness, in the balance.

    stretch * theta, and besides, in form "wire", softness * reach * (1 - exp(-|theta| / reach)) of
    a free joint: a wire that is soft while it is loose and hardens with its force; `stiffness` is
    the joint's over the wire's. In form "toe" the wire hardens with its own stretch e instead, as
    ropes do: it pulls by e - toe * length * (1 - exp(-e / length)). Its parameters mean the same:
    softness at first, and the reach within which half of that is gone. In form "off home" the wire
    is loose at theta = centre, where the joint's own spring is at rest. Source: two springs in
    series; toe region of wire ropes, Feyrer, Wire Ropes (2015), section 2.3; of tendons, Fung,
    Biomechanics (1993), section 7.3.
    """

    grows: ClassVar = {"wire": ("toe", OFF_HOME)}

    def __init__(self, form: str = "wire") -> None:
        self.form = form
        self.own_law = form in ("toe", OFF_HOME)

    def richer(self) -> tuple[Term, ...]:
        return (*super().richer(), DrivenStretch()) if self.form == "wire" else ()

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        half = 0.5 * around.angle_span
        wire = (
            Parameter("softness", "", 0.0, 0.8, 0.2, 0.2),
            Parameter("reach", around.angle_unit, 0.01 * half, 2.0 * half, 0.2 * half, 0.2 * half),
            STRETCH,
            Parameter("stiffness", "", 0.002, 2.0, 0.2, 0.05, weak=True),
        )
        return (*wire, centre(around)) if self.form == OFF_HOME else wire

    def void(self, values: np.ndarray) -> bool:
        return bool(values[0] == 0.0 and values[2] == 0.0)

    def load(self, values: np.ndarray, motion: Motion, state: np.ndarray | None) -> Load:
        softness, reach, stretch, stiffness, *middle = values.tolist()
        if self.form == "toe":
            toe = softness / (softness + stiffness)
            half_gone = np.log(2.0 - toe) - toe * (1.0 - toe) / (2.0 - toe)
            length = stiffness * reach * np.log(2.0) / half_gone
            own = stiffness - stretch
            return Load(toe=(float(own), float(stiffness), float(toe), float(length)))
        most, sharpness = softness * reach, 1.0 / (stiffness * reach)
        return Load(
            smooth=(float(stretch), 0.0, 0.0, 0.0),
            give=np.array([[most, sharpness, stiffness, *(middle or [0.0])]]),
        )

    def plainer(self, values: np.ndarray, shown: Shown) -> str:
        """Wire that gives way within less than a step and no more hung slack.

        But not a toe, which hardens on the way.
        """
        if self.form == "toe":
            return self.name
        return "slack" if self.given_way(values, values[1]) < shown.step else self.name

    def may_be_itself(self, values: np.ndarray, around: Surroundings, shown: Shown) -> bool:
        """Where the wire may as well give way over more than a step."""
        return self.form != "toe" and self.given_way(values, shown.most(1)) > shown.step

    def given_way(self, values: np.ndarray, reach: float) -> float:
        """How far the wire stretches within a reach of the joint [angle unit]."""
        stretch, stiffness = values[2:4]
        return float(reach * stiffness / (stiffness + stretch))

    def instead(self, values: np.ndarray, motion: Motion, around: Surroundings) -> Sequence[Told]:
        """Slack that loses as much, where that is soon lost: at the joint, or of the drive."""
        from pipeline.physics.slack import slack_as  # which offers a toe, as this offers it

        softness, reach = values[:2]
        if reach > SOON * around.angle_span:
            return ()
        scale = around.drive_span / around.angle_span
        lost, way = float(scale * softness * reach), float(scale * reach)
        return [[told] for told in (slack_as(lost), *driven_as(lost, way))]

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        half = 0.5 * around.angle_span
        if self.form == "toe":
            starts = ((0.4, 0.1, 0.2), (0.2, 0.2, 0.2), (0.2, 0.4, 0.2), (0.2, 0.2, 0.1))
            return np.array([[s, r * half, 0.0, k] for s, r, k in starts])
        reaches = (0.05, 0.12, 0.25, 0.5) if self.form == "wire" else (0.1, 0.3)
        wire = [[0.1, r * half, 0.0, 0.1] for r in reaches]
        if self.form == "wire":
            return np.array(wire)
        return np.array([[*w, c] for w in wire for c in centres(around, (-0.3, -0.1, 0.1, 0.3))])

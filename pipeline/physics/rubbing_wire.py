"""Friction of the wire itself: ahead of its slack, and of all that loads the joint."""

from collections.abc import Sequence

import numpy as np

from pipeline.physics.balance import BALANCE, settle
from pipeline.physics.friction import Friction
from pipeline.physics.kinematics import IdentityCurve
from pipeline.physics.motion import Motion
from pipeline.physics.piece import Piece
from pipeline.physics.pre_sliding import FASTEST, WIDEST
from pipeline.physics.term import Parameter, Surroundings, Told

AHEAD = "ahead"
REACHES = (0.02, 0.08, 0.3)


class RubbingWire(Friction):
    """u = x + width / 2 z(x): the wire between the drive u and its own far end x, which rubs.

    z is the share of the sliding friction that acts, of a bank of slip elements or, in form
    "bristle ahead", of one bristle, as `Friction` has them at the joint. Here it rubs in its sheath
    between the motor and what hangs slack: no load of the joint changes it, and it holds none.
    Source: an elastic wire behind a dry contact, Iwan (1966), Dahl (1976); tendons in sheaths,
    Palli, Borghesan and Melchiorri, IEEE Trans. Robot. 28 (2012) 277.
    """

    place = 45.0
    says = (
        "The wire rubs on its way to the joint: {width} lie between the two ways, and it gives way "
        "gradually over the first {reach} of motion."
    )

    def __init__(self, form: str = AHEAD) -> None:
        super().__init__(form)
        self.before_curve, self.in_balance = True, False
        self.at_joint = Friction("bristle" if "bristle" in form else "")

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        unit, span = around.drive_unit, around.drive_span
        bristle = "bristle" in self.form
        return (
            Parameter("width", unit, 0.0, 0.9 * span, 0.05 * span, 0.05 * span, at_drive=True),
            Parameter("reach", unit, 1e-4 * span, span, 0.05 * span, 0.05 * span, at_drive=True),
            Parameter("release", "", 0.0, FASTEST, 0.8, 0.0)
            if bristle
            else Parameter("spread", "", 0.0, WIDEST, 0.7, 0.3),
        )

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        held = [Piece(self.at_joint, values)]
        far_end, states = settle(signal, held, motion, IdentityCurve(), state, {})
        return far_end, states[BALANCE]

    def instead(self, values: np.ndarray, motion: Motion, around: Surroundings) -> Sequence[Told]:
        return ()

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        span = around.drive_span
        return np.vstack([self.as_wide(width * span) for width in (0.01, 0.04, 0.15)])

    def as_wide(self, width: float) -> np.ndarray:
        """Parameter sets (k, 3) of this width, however gradually it gives way."""
        return np.array([[width, part * width, 0.8] for part in REACHES])


RUBBING = (RubbingWire(AHEAD), RubbingWire(f"bristle {AHEAD}"))

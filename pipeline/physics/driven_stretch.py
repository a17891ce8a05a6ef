"""Stretch before the nominal curve: what the drive loses on its way to the joint."""

from collections.abc import Sequence

import numpy as np

from pipeline.physics.compliance import Compliance
from pipeline.physics.driven_slack import driven_as
from pipeline.physics.motion import Motion
from pipeline.physics.term import NO_STATE, Parameter, Surroundings, Told

DRIVEN = "driven"


class DrivenStretch(Compliance):
    """x = u - softness u / (1 + |u / reach|^a)^(1 / a), u the drive off its centre.

    The larger the `abruptness` a, the sooner it is gone at the reach; a wire that loses more than
    half of the way hangs slack, and one that loses nearly as much may sag: that is told as well.
    Source: Richard and Abbott, J. Eng. Mech. Div. ASCE 101 (1975) 511.
    """

    form = DRIVEN
    also = ("slack",)
    before_curve = True
    in_balance = False

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        far, unit = 0.5 * around.drive_span, around.drive_unit
        low, high = min(around.drive_low, 0.0), max(around.drive_low + 2.0 * far, 0.0)
        return (
            Parameter("softness", "", 0.0, 0.5, 0.2, 0.2),
            Parameter("reach", unit, 0.02 * far, 4.0 * far, 0.4 * far, 0.4 * far),
            Parameter("abruptness", "", 0.4, 40.0, 2.0, 0.0),
            Parameter("centre", unit, low, high, 0.0, 0.1 * far, weak=True),
        )

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        softness, reach, abruptness, middle = values
        off = signal - middle
        stretch = softness * off / (1.0 + np.abs(off / reach) ** abruptness) ** (1.0 / abruptness)
        return signal - stretch, NO_STATE

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        far = 0.5 * around.drive_span
        return np.array([[0.2, r * far, a, 0.0] for r in (0.25, 0.7) for a in (1.0, 2.0, 4.0)])

    def instead(self, values: np.ndarray, motion: Motion, around: Surroundings) -> Sequence[Told]:
        """Slack that loses as much, where that is soon lost."""
        softness, reach, _, centre = (float(v) for v in values)
        if reach > SOON * around.drive_span:
            return ()
        return [[told] for told in driven_as(softness * reach, reach, centre)]


SOON = 0.25

"""Slack of a force against motion: near home the spring that is simulated does not pull."""

import numpy as np

from pipeline.number_words import worded
from pipeline.physics.force_term import ForceTerm, per
from pipeline.physics.motion import Kinetics, Motion
from pipeline.physics.term import Parameter, Surroundings

ASIDE = "force aside"
MOST, STIFFEST = 0.7, 20.0
WIDTHS = (0.05, 0.15, 0.35)


class ForceSlack(ForceTerm):
    """F = -stiffness * x within the slack, and as much as at its end beyond it.

    So a simulated spring of that stiffness begins to pull where the slack ends. It reaches half of
    `width` to both sides of home, x = 0; form "force aside" has its middle elsewhere. Source: dead
    zone of a spring.
    """

    name = "slack"
    site = "transmission"
    place = 145.0
    unlikely = 2.0
    says = "Over {width} about home a spring of {stiffness} does not pull."

    def __init__(self, form: str = "force") -> None:
        self.form = form

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        own, span = loose_spring(around, MOST), max(around.drive_span, 1e-12)
        if self.form != ASIDE:
            return own
        low, high = around.drive_low, around.drive_low + span
        return (*own, Parameter("middle", around.drive_unit, low, high, 0.0, 0.1 * span))

    def force(
        self, motion: Motion, kinetics: Kinetics, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray | None]:
        half, middle = 0.5 * values[1], values[2] if self.form == ASIDE else 0.0
        return -values[0] * np.clip(motion.drive, middle - half, middle + half), state

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        own = self.parameters(around)[0].start
        widths = [share * around.drive_span for share in WIDTHS]
        if self.form != ASIDE:
            return np.array([[own, width] for width in widths])
        return np.array([[own, width, 0.5 * way * width] for width in widths for way in (-1, 1)])

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        """Where a motion goes through home, and something is simulated that may not pull."""
        home = around.drive_low < 0.0 < around.drive_low + around.drive_span
        return around.simulated and home and super().excited(motion, around)

    def sentence(self, values: np.ndarray, around: Surroundings) -> str:
        if self.form != ASIDE:
            return super().sentence(values, around)
        unit, half = around.drive_unit, 0.5 * values[1]
        low, high = (worded(values[2] + way * half) for way in (-1.0, 1.0))
        spring = f"{worded(values[0])} {per(around, 0)}"
        return f"From {low} to {high} {unit} a spring of {spring} does not pull."


def loose_spring(around: Surroundings, widest: float) -> tuple[Parameter, Parameter]:
    """The stiffness of a simulated spring, and the width over which it does not pull.

    widest: share of the way that this may be.
    """
    span = max(around.drive_span, 1e-12)
    usual = around.angle_span / span
    return (
        Parameter("stiffness", per(around, 0), 0.0, STIFFEST * usual, usual, usual),
        Parameter("width", around.drive_unit, 0.0, widest * span, WIDTHS[0] * span, 0.0,
                  relative=True),
    )  # fmt: skip

"""A single bump: the drive runs ahead at one place, as over a damaged tooth."""

import numpy as np

from pipeline.number_words import worded
from pipeline.physics.motion import Motion
from pipeline.physics.term import NO_STATE, Parameter, Surroundings, Term

BUMP = "bump"
WIDTHS = (0.03, 0.06, 0.1)
WIDEST, UNUSUAL = 0.1, 6.0


class SingleBump(Term):
    """x = u + height exp(-((u - middle) / width)^2).

    The drive goes at least as far beyond it on either side as it is wide at most: what only begins
    within the range is a bend. A ripple comes again and again, and this does not: the catalogue has
    no word of its own for it. Source: local transmission error of a damaged tooth, Howard, Jia and
    Wang, Mech. Syst. Signal Process. 15 (2001) 831.
    """

    name = "transmission_ripple"
    form = BUMP
    site = "actuator"
    place = 20.0
    before_curve = True
    unlikely = UNUSUAL
    beyond = "a bump at one place of the drive"
    says = "At one place the drive runs ahead or behind by {height}, as over a damaged tooth."

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        span, low, unit = around.drive_span, around.drive_low, around.drive_unit
        edge = WIDEST * span
        middle = low + 0.5 * span
        return (
            Parameter("height", unit, -0.3 * span, 0.3 * span, 0.01 * span, 0.01 * span),
            Parameter("middle", unit, low + edge, low + span - edge, middle, 0.0),
            Parameter("width", unit, 0.5 * around.spacing, WIDEST * span, 0.06 * span, 0.0),
        )

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        height, middle, width = values
        return signal + height * np.exp(-(((signal - middle) / width) ** 2)), NO_STATE

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        span, low = around.drive_span, around.drive_low
        return np.array(
            [
                [0.01 * span, low + middle * span, width * span]
                for width in WIDTHS
                for middle in np.arange(WIDEST, 1.0 - WIDEST + 1e-9, width)
            ]
        )

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        return around.spacing < WIDTHS[0] * around.drive_span

    def sentence(self, values: np.ndarray, around: Surroundings) -> str:
        height, middle, width = values
        way, unit = "ahead" if height > 0.0 else "behind", around.drive_unit
        return (
            f"At {worded(middle)} {unit} the drive runs {way} by {worded(abs(height))} {unit} "
            f"within {worded(width)} {unit}, and nowhere else, as over a damaged tooth."
        )

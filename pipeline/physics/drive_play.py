"""Play of the drive: what its kinds share."""

import numpy as np

from pipeline.physics.term import Parameter, Surroundings, Term

SHARES = np.array([0.003, 0.01, 0.03, 0.1])


class DrivePlay(Term):
    """A gap of `width` behind the drive, its first parameter; a load starts in the middle of it.

    Dry friction F that holds what a wire of stiffness k pulls leaves the same motion, to the
    letter, as a gap of 2 F / k, in whatever loops: no position tells them apart, and both are told.
    Source: Krasnosel'skii and Pokrovskii, Systems with Hysteresis (1989), section 2.
    """

    name = "backlash"
    site = "transmission"
    place = 30.0
    remembers = "way"
    before_curve = True
    group = "play"

    def width(self, around: Surroundings) -> Parameter:
        """How wide the gap is [drive unit]."""
        span, unit = around.drive_span, around.drive_unit
        return Parameter("width", unit, 0.0, 0.9 * span, 0.05 * span, 0.05 * span)

    def widths(self, around: Surroundings) -> np.ndarray:
        """Widths to begin a search from, (k,) [drive unit]."""
        return around.drive_span * SHARES

    def other_names(self, values: np.ndarray, around: Surroundings) -> tuple[str, ...]:
        return ("friction",)

"""Play of a force against motion: the spring that is simulated hangs in a gap."""

import numpy as np

from pipeline.physics.force_slack import WIDTHS, loose_spring
from pipeline.physics.force_term import ForceTerm
from pipeline.physics.motion import Kinetics, Motion
from pipeline.physics.play_operator import play
from pipeline.physics.term import Parameter, Surroundings

WIDEST = 0.9


class ForcePlay(ForceTerm):
    """F = -stiffness * (x - p), p the play operator of x with a gap of `width`.

    So a simulated spring of that stiffness is stretched by p in place of x. It begins in the middle
    of its gap. Source: play operator.
    """

    name = "backlash"
    site = "transmission"
    form = "force"
    place = 144.0
    remembers = "way"
    unlikely = 2.0
    says = "A spring of {stiffness} hangs in a gap of {width}: after each reversal it stays behind."

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        return loose_spring(around, WIDEST)

    def force(
        self, motion: Motion, kinetics: Kinetics, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray | None]:
        x = np.ascontiguousarray(motion.drive)
        start = float(x[0] if state is None else state[0])
        followed = play(x, 0.5 * float(values[1]), start)
        return -values[0] * (x - followed), followed[-1:].copy()

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        own = self.parameters(around)[0].start
        return np.array([[own, share * around.drive_span] for share in WIDTHS])

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        """Where something is simulated that may hang in a gap."""
        return around.simulated and super().excited(motion, around)

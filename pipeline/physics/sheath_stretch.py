"""How far a wire stretches in its sheath, where friction takes a share of its pull."""

import numpy as np
from numba import njit

from pipeline.physics.force_units import FORCES, LENGTHS
from pipeline.physics.motion import Motion
from pipeline.physics.term import Parameter, Surroundings, Term

PLACES = 16
LEAST_PULL = 1e-9


@njit(cache=True)
def _mean_pull(logs, halves, state):  # type: ignore[no-untyped-def]
    """Mean over the wire of its pull, (n,): at each place a play in the logarithm (in place)."""
    out = np.empty(logs.size)
    for i in range(logs.size):
        total = 0.0
        for j in range(halves.size):
            state[j] = max(logs[i] - halves[j], min(logs[i] + halves[j], state[j]))
            total += np.exp(state[j])
        out[i] = total / halves.size
    return out


class SheathStretch(Term):
    """The mean of a wire's pull over its length: at a share s of it a play of log(pull).

    The play's half-width there is wrap s^where: where = 1 is an even bend, more is a bend towards
    the far end; wrap = friction coefficient times the angle that the wire is bent by. After each
    reversal the change sets in at the near end and wanders to the far one, so that the stretch
    turns round gradually. pull = drive + pretension, which stands for the zero of the force's
    sensor, too. It begins as it was tightened. Source: capstan equation (Euler 1769; Eytelwein
    1808), place by place as in Kaneko et al., IEEE Trans. Robot. Autom. 7 (1991) 351.
    """

    name = "friction"
    site = "transmission"
    place = 60.0
    remembers = "way"
    form = "stretch"
    before_curve = True
    says = (
        "The sheath holds the wire back by a share of its pull: at the far end the two ways differ "
        "by a factor of exp(2 x {wrap})."
    )

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        span, least = around.drive_span, -around.drive_low
        return (
            Parameter("wrap", "", 0.0, 5.0, 0.3, 0.2),
            Parameter("where", "", 0.2, 5.0, 1.0, 0.5),
            Parameter("pretension", around.drive_unit, least, least + 2.0 * span,
                      max(least, 0.0) + 0.02 * span, 0.05 * span),
        )  # fmt: skip

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        wrap, where, pretension = (float(v) for v in values)
        logs = np.log(np.maximum(signal + pretension, LEAST_PULL))
        halves = wrap * ((np.arange(PLACES) + 0.5) / PLACES) ** where
        at = logs[0] - halves if state is None else state.copy()
        return _mean_pull(logs, halves, at), at

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        zero = self.parameters(around)[2].start
        return np.array([[wrap, 1.0, zero] for wrap in (0.05, 0.15, 0.4, 0.8, 1.5)])

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        """Where a force goes in and a length comes out, and the wire is pulled all the time."""
        taut = around.drive_low > -0.05 * around.drive_span
        moves = around.drive_span > 0.0 and around.angle_unit in LENGTHS
        return moves and around.drive_unit in FORCES and taut

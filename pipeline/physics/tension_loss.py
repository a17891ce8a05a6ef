"""Tension loss: play that grows from cycle to cycle."""

from typing import ClassVar

import numpy as np
from numba import njit

from pipeline.physics.motion import Motion
from pipeline.physics.term import Parameter, Surroundings, Term

SOONER = 0.5


@njit(cache=True)
def worn_play(drive, width, growth, onset, settled, at, last, travel):  # type: ignore[no-untyped-def]
    """The play operator, (n,), with a width that grows with the travel, and the travel in the end.

    onset: travel before which nothing grows; settled: over which growth fades, inf for never. at,
    last, travel: where the play, the drive and its travel were before.
    """
    out = np.empty(drive.size)
    for i in range(drive.size):
        travel += abs(drive[i] - last)
        last = drive[i]
        worn = max(travel - onset, 0.0)
        if settled < np.inf:
            worn = -settled * np.expm1(-worn / settled)
        half = 0.5 * (width + growth * worn)
        at = max(at, last - half) if last - half > at else min(at, last + half)
        out[i] = at
    return out, travel


class TensionLoss(Term):
    """Play of a width that grows with the travel s of the drive: wear, or slackening.

    Forms: "linear" w = width + growth s; "late" w = width + growth max(s - onset, 0); "settling"
    w = width + growth settled (1 - exp(-s / settled)). Source: the play operator with a width that
    changes; wear in proportion to the way slid (Archard, J. Appl. Phys. 24 (1953) 981).
    """

    name = "tension_loss"
    site = "transmission"
    before_curve = True
    group = "play"
    far_apart = True
    grows: ClassVar = {"linear": ("late", "settling")}
    says = "The wire slackens: its play was {width} at the start and grows by {growth} of travel."

    def __init__(self, form: str = "linear") -> None:
        self.form = form

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        span, unit = around.drive_span, around.drive_unit
        travel = around.travel
        most = span / travel
        own = (
            Parameter("growth", f"{unit}/{unit}", 0.0, 4.0 * most, 0.05 * most, 0.05 * most),
            Parameter("width", unit, 0.0, 0.8 * span, 0.02 * span, 0.05 * span),
        )
        if self.form == "late":
            return (*own, Parameter("onset", unit, 0.0, 0.9 * travel, 0.2 * travel, 0.0))
        if self.form == "settling":
            low, high = 0.05 * travel, 5.0 * travel
            return (*own, Parameter("settled", unit, low, high, 0.7 * travel, 0.0))
        return own

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        if state is None:
            state = np.array([signal[0], signal[0], 0.0])
        growth, width, *more = values
        onset = more[0] if self.form == "late" else 0.0
        settled = more[0] if self.form == "settling" else np.inf
        out, travel = worn_play(signal, width, growth, onset, settled, *state)
        return out, np.array([out[-1], signal[-1], travel])

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        growths = around.drive_span / around.travel * np.array([0.01, 0.05, 0.2])
        rows = [[g, w * around.drive_span] for g in growths for w in (0.0, 0.02, 0.06)]
        if self.form == "linear":
            return np.array(rows)
        return np.array([[*r, s * around.travel] for r in rows for s in (0.15, 0.4)])

    def retold(self, starts: np.ndarray) -> np.ndarray:
        """Play that settles looks steady once it has: as wide by then, it may all have grown."""
        if self.form != "settling":
            return starts
        sooner = starts * [1.0, 1.0, SOONER]
        grown = np.vstack([starts, sooner])
        grown[:, 0] += grown[:, 1] / grown[:, 2]
        grown[:, 1] = 0.0
        return np.vstack([starts, grown])

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        return around.cycles >= 2 and around.travel > 0.0

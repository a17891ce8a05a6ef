"""Creep: part of the motion arrives late."""

from typing import ClassVar

import numpy as np

from pipeline.physics.balance import Load
from pipeline.physics.motion import Motion
from pipeline.physics.term import Parameter, Surroundings, Term


def dwells(motion: Motion, last_time: float) -> np.ndarray:
    """Time that each command had before its sample was taken, (n,) [s]."""
    return np.diff(motion.time_s, prepend=last_time)


class Creep(Term):
    """A spring with a dashpot beside the joint: it resists at first and gives way with time.

    In the balance, arm_j = s_j (theta - v_j), v_j' = (theta - v_j) / tau_j, with one or two arms.
    Of each motion of a free joint the `share` s / (1 + s) arrives late, with `time_constant` (1 +
    s) tau. Source: standard linear solid (Zener); the command is held through each dwell.
    """

    name = "creep"
    site = "transmission"
    in_balance = True
    timed = True
    far_apart = True
    grows: ClassVar = {"one": ("two",)}
    says = "Part of each motion ({share}) arrives late, with a time constant of {time_constant}."

    def __init__(self, form: str = "one") -> None:
        self.form = form

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        dwell = max(around.dwell_s, 1e-9)
        longest = max(around.end_s - around.start_s, 10.0 * dwell)
        own = (
            Parameter("share", "", 0.0, 0.8, 0.1, 0.1),
            Parameter("time_constant", "s", 0.2 * dwell, longest, 5.0 * dwell, 0.0),
        )
        if self.form != "two":
            return own
        return (
            *own,
            Parameter("share_2", "", 0.0, 0.8, 0.02, 0.1),
            Parameter("time_constant_2", "s", 0.2 * dwell, 3 * longest, 80.0 * dwell, 0.0),
        )

    def load(self, values: np.ndarray, motion: Motion, state: np.ndarray | None) -> Load:
        share, time_constant = values[0::2], values[1::2]
        arm = np.empty((len(share), 2))
        arm[:, 0] = share / (1.0 - share)
        arm[:, 1] = time_constant * (1.0 - share)
        return Load(arm=arm)

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        dwell = max(around.dwell_s, 1e-9)
        rows = [[0.05, k * dwell] for k in (0.6, 1.5, 4.0, 10.0, 25.0, 60.0)]
        if self.form == "two":
            rows = [[*r, 0.02, 12.0 * r[1]] for r in rows]
        return np.array(rows)

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        return around.drive_span > 0.0 and around.dwell_s > 0.0

    def retold(self, starts: np.ndarray) -> np.ndarray:
        """What one arm does in the middle, two do: one that is quicker, and one that is slower."""
        if self.form != "two":
            return starts
        share, time_constant = starts[0, :2]
        own = [share, time_constant, share, time_constant]
        return np.vstack([starts, np.multiply(own, APART)])


APART = (
    (0.5, 0.15, 0.9, 1.2),
    (0.9, 0.3, 0.5, 2.0),
    (0.5, 0.3, 0.9, 1.5),
    (0.2, 0.15, 0.9, 1.05),
)

"""Creep: part of the motion arrives late."""

from typing import ClassVar

import numpy as np

from pipeline.physics.balance import Load
from pipeline.physics.held import dwells, slewed
from pipeline.physics.motion import Motion
from pipeline.physics.term import Parameter, Surroundings, Term


class Creep(Term):
    """A spring with a dashpot beside the joint: it resists at first and gives way with time.

    In the balance, arm_j = s_j (theta - v_j), v_j' = (theta - v_j) / tau_j, with one or two arms.
    Of each motion of a free joint the `share` s / (1 + s) arrives late, with `time_constant` (1 +
    s) tau. Form "whole", after the balance: as much of each motion arrives late whatever loads the
    joint. Source: standard linear solid (Zener); the command is held through each dwell.
    """

    name = "creep"
    site = "transmission"
    timed = True
    far_apart = True
    grows: ClassVar = {"one": ("two",)}
    says = "Part of each motion ({share}) arrives late, with a time constant of {time_constant}."

    def __init__(self, form: str = "one") -> None:
        self.form = form
        self.in_balance = form != "whole"

    @property
    def kin(self) -> str:
        return "one" if self.form == "whole" else self.form

    def outside(self) -> Term | None:
        return Creep("whole") if self.form == "one" else None

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

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        time_s, at = (motion.time_s[0], signal[0]) if state is None else state
        dwell, asked = dwells(motion, float(time_s)), np.ascontiguousarray(signal)
        late = slewed(asked, dwell, float(values[1]), np.inf, float(at))
        return signal + values[0] * (late - signal), np.array([motion.time_s[-1], late[-1]])

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

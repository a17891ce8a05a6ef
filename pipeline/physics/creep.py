"""Creep: part of the motion arrives late."""

import numpy as np
from numba import njit

from pipeline.physics.motion import Motion
from pipeline.physics.term import Parameter, Surroundings, Term


@njit(cache=True)
def lagged(signal: np.ndarray, decay: np.ndarray, start: float) -> np.ndarray:
    """A first-order lag: what is left of the distance to each sample after its own dwell."""
    out = np.empty(signal.size)
    at = start
    for i in range(signal.size):
        at = signal[i] + (at - signal[i]) * decay[i]
        out[i] = at
    return out


def dwells(motion: Motion, last_time: float) -> np.ndarray:
    """Time that each command had before its sample was taken, (n,) [s]."""
    return np.diff(motion.time_s, prepend=last_time)


class Creep(Term):
    """x = u - sum_j share_j (u - v_j), v_j' = (u - v_j) / tau_j; one or two time constants.

    Source: standard linear solid (Zener), a Maxwell arm for each time constant; exact for a command
    that is held through each dwell.
    """

    name = "creep"
    site = "transmission"
    before_curve = True
    says = "Part of each motion ({share}) arrives late, with a time constant of {time_constant}."

    def __init__(self, form: str = "one") -> None:
        self.form = form

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        dwell = max(around.dwell_s, 1e-9)
        longest = max(around.end_s - around.start_s, 10.0 * dwell)
        own = (
            Parameter("share", "", 0.0, 0.9, 0.1, 0.1),
            Parameter("time_constant", "s", 0.2 * dwell, longest, 5.0 * dwell, 0.0),
        )
        if self.form != "two":
            return own
        return (
            *own,
            Parameter("share_2", "", 0.0, 0.9, 0.02, 0.1),
            Parameter("time_constant_2", "s", 0.2 * dwell, 3 * longest, 80.0 * dwell, 0.0),
        )

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        arms = len(values) // 2
        if state is None:
            state = np.array([motion.time_s[0], *(arms * [signal[0]])])
        dwell = dwells(motion, float(state[0]))
        out = signal.copy()
        after = np.empty(1 + arms)
        after[0] = motion.time_s[-1]
        for j in range(arms):
            share, tau = values[2 * j], values[2 * j + 1]
            late = lagged(signal, np.exp(-dwell / tau), float(state[1 + j]))
            out += share * (late - signal)
            after[1 + j] = late[-1]
        return out, after

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        dwell = max(around.dwell_s, 1e-9)
        rows = [[0.05, k * dwell] for k in (0.6, 1.5, 4.0, 10.0, 25.0, 60.0)]
        if self.form == "two":
            rows = [[*r, 0.02, 12.0 * r[1]] for r in rows]
        return np.array(rows)

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        return around.drive_span > 0.0 and around.dwell_s > 0.0

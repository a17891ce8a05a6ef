"""A lag that is longer one way than the other: a damper with a valve."""

import numpy as np
from numba import njit

from pipeline.number_words import worded
from pipeline.physics.held import dwells, longest_lag_s
from pipeline.physics.motion import Motion
from pipeline.physics.term import Parameter, Surroundings, Term

RATIOS = (0.4, 2.5)
LEAST, MOST = 0.05, 20.0


@njit(cache=True)
def valved(signal, dwell, rising, falling, at):  # type: ignore[no-untyped-def]
    """x' = (u - x) / tau of a command held through each dwell (n,) [s], tau by the way it goes.

    Exact, as x never passes u. at: x before.
    """
    out = np.empty(signal.size)
    for i in range(signal.size):
        late = rising if signal[i] > at else falling
        left = np.exp(-dwell[i] / late) if late > 0.0 else 0.0
        at = signal[i] + left * (at - signal[i])
        out[i] = at
    return out


class ValvedLag(Term):
    """x' = (u - x) / tau, tau = time_constant while x rises, ratio time_constant while it falls.

    A damper that is harder one way, muscles that fill sooner than they empty; whatever loads the
    joint. Source: first-order lag, one for each way.
    """

    name = "response_lag"
    site = "body"
    place = 90.0
    remembers = "time"
    group = "lag"
    timed = True
    form = "valved"
    says = "The whole motion comes late, with a time constant of {time_constant} as it rises"

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        dwell, longest = max(around.dwell_s, 1e-9), longest_lag_s(around)
        return (
            Parameter("time_constant", "s", 0.0, longest, dwell, dwell),
            Parameter("ratio", "", LEAST, MOST, 1.0, 0.5),
        )

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        last_s, at = (motion.time_s[0], signal[0]) if state is None else state
        asked, rising = np.ascontiguousarray(signal), float(values[0])
        dwell = dwells(motion, float(last_s))
        out = valved(asked, dwell, rising, rising * float(values[1]), float(at))
        return out, np.array([motion.time_s[-1], out[-1]])

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        dwell = max(around.dwell_s, 1e-9)
        return np.array([[k * dwell, r] for k in (0.3, 1.0, 4.0) for r in RATIOS])

    def sentence(self, values: np.ndarray, around: Surroundings) -> str:
        falling = worded(values[0] * values[1])
        return f"{super().sentence(values, around)}, and of {falling} s as it falls."

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        return around.drive_span > 0.0 and around.dwell_s > 0.0

"""Lag of a force against motion: what is measured follows the force late."""

import numpy as np
from numba import njit

from pipeline.physics.decay import decayed
from pipeline.physics.force_term import ForceTerm
from pipeline.physics.motion import Motion
from pipeline.physics.term import Parameter, Surroundings

LATE = "force"
LEAST, LAGS = 2.0, (2.5, 6.0, 15.0)
LONGEST = 0.1


class ForceLag(ForceTerm):
    """f' = (F - f) / time_constant of all the force, which runs straight from sample to sample.

    As behind a sensor's or an amplifier's filter; LEAST samples long, for what is shorter is a
    delay. Exact, however unevenly sampled; it begins settled. Source: first-order lag.
    """

    name = "response_lag"
    place = 190.0
    remembers = "time"
    form = LATE
    adds = False
    says = "The force comes late as a whole, with a time constant of {time_constant}."

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        sample_s = max(around.dwell_s, 1e-9)
        longest_s = max(30.0 * sample_s, LONGEST * around.period_s)
        usual_s = LAGS[0] * sample_s
        return (Parameter("time_constant", "s", LEAST * sample_s, longest_s, usual_s, 0.0,
                          relative=True),)  # fmt: skip

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        time_s, forces = motion.time_s, np.ascontiguousarray(signal)
        begun = np.array([time_s[0], forces[0], forces[0]]) if state is None else state
        out = _late(forces, time_s, float(values[0]), *begun)
        return out, np.array([time_s[-1], forces[-1], out[-1]])

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        most = self.parameters(around)[0].high
        return np.array([[min(lag * around.dwell_s, most)] for lag in LAGS])


@njit(cache=True, error_model="numpy")
def _late(force, time_s, time_constant, then_s, before, late):  # type: ignore[no-untyped-def]
    out = np.empty(force.size)
    for i in range(force.size):
        past_s = time_s[i] - then_s
        if past_s > 0.0:
            left = decayed(past_s / time_constant)
            trail = (force[i] - before) / past_s * time_constant
            late = force[i] - trail + left * (late - before + trail)
        then_s, before = time_s[i], force[i]
        out[i] = late
    return out

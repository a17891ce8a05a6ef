"""Lag of a force against motion: what is measured follows the force late."""

from typing import ClassVar

import numpy as np
from numba import njit

from pipeline.number_words import worded
from pipeline.physics.decay import decayed
from pipeline.physics.force_term import ForceTerm
from pipeline.physics.motion import Motion
from pipeline.physics.second_order_lag import swung
from pipeline.physics.term import Parameter, Surroundings

LATE, SWINGING = "force", "force second"
LEAST, LAGS, DAMPINGS = 2.0, (2.5, 6.0, 15.0, 40.0), (0.3, 0.8)
MOST_SAMPLES, LONGEST = 100.0, 0.1


class ForceLag(ForceTerm):
    """f' = (F - f) / time_constant of all the force, which runs straight from sample to sample.

    As behind a sensor's or an amplifier's filter; LEAST samples long, for what is shorter is a
    delay. Form "force second" swings: f'' = w^2 (F - f) - 2 damping w f', as a load cell with a
    mass on it. Exact, however unevenly sampled; it begins settled. Source: first-order lag; linear
    system of second order.
    """

    name = "response_lag"
    place = 190.0
    remembers = "time"
    adds = False
    grows: ClassVar = {LATE: (SWINGING,)}
    says = "The force comes late as a whole, with a time constant of {time_constant}."
    says_of_second = (
        "The force swings after what the motion asks for, with a natural frequency of {frequency} "
        "and a damping of {damping}."
    )

    def __init__(self, form: str = LATE) -> None:
        self.form = form

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        sample_s = max(around.dwell_s, 1e-9)
        longest_s = max(MOST_SAMPLES * sample_s, LONGEST * around.period_s)
        usual_s = LAGS[0] * sample_s
        if self.form == SWINGING:
            return (
                Parameter("natural_frequency", "rad/s", 1.0 / longest_s, 1.0 / sample_s,
                          1.0 / usual_s, 0.0, relative=True),
                Parameter("damping", "", 0.02, 5.0, 0.7, 0.5),
            )  # fmt: skip
        return (Parameter("time_constant", "s", LEAST * sample_s, longest_s, usual_s, 0.0,
                          relative=True),)  # fmt: skip

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        time_s, forces = motion.time_s, np.ascontiguousarray(signal)
        if self.form == SWINGING:
            begun = np.array([time_s[0], forces[0], 0.0, forces[0]]) if state is None else state
            past_s = np.diff(time_s, prepend=begun[0])
            out, last = swung(forces, past_s, past_s, values[0], values[1], begun[3], begun[1:3])
            return out, np.concatenate([time_s[-1:], last])
        begun = np.array([time_s[0], forces[0], forces[0]]) if state is None else state
        out = _late(forces, time_s, float(values[0]), *begun)
        return out, np.array([time_s[-1], forces[-1], out[-1]])

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        lags_s = np.array(LAGS) * around.dwell_s
        if self.form == SWINGING:
            return np.array([[1.0 / lag_s, damping] for lag_s in lags_s for damping in DAMPINGS])
        return np.minimum(lags_s, self.parameters(around)[0].high)[:, None]

    def sentence(self, values: np.ndarray, around: Surroundings) -> str:
        if self.form != SWINGING:
            return super().sentence(values, around)
        return self.says_of_second.format(
            frequency=f"{worded(values[0])} rad/s", damping=f"{values[1]:.2g}"
        )


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

"""Creep that is helped by the stress: what is late comes the sooner the more of it there is."""

import numpy as np
from numba import njit

from pipeline.physics.arriving_late import TIMES, ArrivingLate, share_and_time
from pipeline.physics.held import dwells
from pipeline.physics.motion import Motion
from pipeline.physics.term import Parameter, Surroundings

ACTIVATED = "activated"
SOFTEST, FIRMEST = 2e-3, 0.5
ACTIVATIONS = (0.01, 0.05, 0.2)
NEARLY = 1.0 - 1e-15  # of 1, which no time at all would leave


@njit(cache=True, error_model="numpy")
def flowed(signal, dwell, time_constant, activation, at):  # type: ignore[no-untyped-def]
    """x' = activation / time_constant sinh((u - x) / activation), u held: exact answer (n,)."""
    out = np.empty(signal.size)
    for i in range(signal.size):
        left = np.tanh(0.5 * (signal[i] - at) / activation) * np.exp(-dwell[i] / time_constant)
        at = signal[i] - 2.0 * activation * np.arctanh(min(max(left, -NEARLY), NEARLY))
        out[i] = at
    return out


class ActivatedCreep(ArrivingLate):
    """x = u - share (u - late), late' = activation / tau sinh((u - late) / activation).

    Whatever loads the joint; the command is held through each dwell. tau is the `time_constant` of
    what is late by much less than the `activation`; what is late by more flows faster by orders of
    magnitude, as polymers and waxed wires do. Exact: tanh((u - late) / 2 activation) falls as
    exp(-t / tau). Source: Eyring, J. Chem. Phys. 4 (1936) 283.
    """

    form = ACTIVATED
    says = (
        "Part of each motion ({share}) arrives late, the faster the more of it is late, its last "
        "with a time constant of {time_constant}."
    )

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        unit, span = around.angle_unit, around.angle_span
        low, high, start = (k * span for k in (SOFTEST, FIRMEST, ACTIVATIONS[1]))
        activation = Parameter("activation", unit, low, high, start, 0.0, relative=True)
        return (*share_and_time(around), activation)

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        share, late_s, activation = (float(v) for v in values)
        last_s, at = (motion.time_s[0], signal[0]) if state is None else state
        asked, dwell = np.ascontiguousarray(signal), dwells(motion, float(last_s))
        late = flowed(asked, dwell, late_s, activation, float(at))
        return signal + share * (late - signal), np.array([motion.time_s[-1], late[-1]])

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        dwell, span = max(around.dwell_s, 1e-9), around.angle_span
        return np.array([[0.1, k * dwell, a * span] for a in ACTIVATIONS for k in TIMES])

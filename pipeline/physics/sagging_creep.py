"""Creep of a loaded wire: what has arrived is given back in part."""

from dataclasses import replace

import numpy as np

from pipeline.physics.arriving_late import TIMES, ArrivingLate, share_and_time
from pipeline.physics.held import STEP_AND_WAIT_S, dwells, trailed
from pipeline.physics.motion import Motion
from pipeline.physics.term import Parameter, Surroundings

BRIEFEST, UNUSUAL = 2.0, 6.0


class SaggingCreep(ArrivingLate):
    """x = u + share (u - late), late' = (u - late) / time_constant.

    A wire that lengthens with time under the pull that a joint's spring holds against it: each
    motion arrives whole and sags back by `share` of it. The command runs straight from sample to
    sample: where a robot steps and waits, a loop that any law runs the other way round looks alike.
    Source: Kelvin's element in series with a wire (Findley, Lai and Onaran, Creep and Relaxation
    (1976), ch. 5).
    """

    form = "sagging"
    unlikely = UNUSUAL
    beyond = "that what has arrived is given back in part"
    says = (
        "Part of each motion ({share}) is given back, with a time constant of {time_constant}, as "
        "by a wire that lengthens under its load."
    )

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        share, late = share_and_time(around)
        return share, replace(late, low=BRIEFEST * max(around.dwell_s, 1e-9))

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        share, late_s = (float(v) for v in values)
        start = (motion.time_s[0], signal[0], signal[0]) if state is None else state
        last_s, before, at = (float(v) for v in start)
        asked, dwell = np.ascontiguousarray(signal), dwells(motion, last_s)
        late = trailed(asked, dwell, late_s, 1.0, before, at)
        return signal + share * (signal - late), np.array([motion.time_s[-1], signal[-1], late[-1]])

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        return np.array([[0.1, k * max(around.dwell_s, 1e-9)] for k in TIMES[2:]])

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        return around.dwell_s < STEP_AND_WAIT_S and super().excited(motion, around)

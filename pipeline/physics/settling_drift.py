"""A zero that comes to rest: a camera that warms up, a mount that beds in."""

from typing import ClassVar

import numpy as np

from pipeline.physics.drift import Drift, amplitude, duration_s
from pipeline.physics.motion import Motion
from pipeline.physics.term import Parameter, Surroundings

WARMING, LATE, CYCLE = "exponential", "settling", "settling cycle"
QUICKEST = {WARMING: 0.02, LATE: 0.1}
"""Shortest time constants [share of the recording]."""
QUICKEST_CYCLES, FEWEST = 0.3, 5


class SettlingDrift(Drift):
    """d = amplitude (1 - exp(-t / tau)).

    Forms: "exponential"; "settling" the same with a tau of at least a tenth of the recording:
    settled sooner, it is an offset; "settling cycle" d = amplitude (1 - exp(-n / constant)), n the
    number of the cycle. Source: thermal drift of first order.
    """

    grows: ClassVar = {WARMING: (CYCLE,)}

    def __init__(self, form: str = WARMING) -> None:
        self.form = form

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        if self.form == CYCLE:
            most = 2.0 * max(around.cycles, 1)
            constant = Parameter("constant", "cycles", QUICKEST_CYCLES, most, 2.0, 0.0)
            return (amplitude(around), constant)
        whole = duration_s(around)
        quickest = QUICKEST[self.form] * whole
        tau = Parameter("time_constant", "s", quickest, 2 * whole, whole / 4, 0.0)
        return (amplitude(around), tau)

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        first = np.array([motion.time_s[0], motion.cycle[0]]) if state is None else state
        gone = motion.cycle - first[1] if self.form == CYCLE else motion.time_s - first[0]
        return signal - values[0] * np.expm1(-gone / values[1]), first

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        size = 0.01 * around.angle_span
        if self.form == CYCLE:
            return np.array([[size, cycles] for cycles in (1.0, 2.5)])
        shares = [s for s in (0.03, 0.1, 0.3, 1.0) if s >= QUICKEST[self.form]]
        return np.array([[size, s * duration_s(around)] for s in shares])

    def void(self, values: np.ndarray) -> bool:
        return bool(values[0] == 0.0)

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        """By the cycle where there are FEWEST: less show no course from cycle to cycle."""
        shows = self.form != CYCLE or around.cycles >= FEWEST
        return shows and super().excited(motion, around)

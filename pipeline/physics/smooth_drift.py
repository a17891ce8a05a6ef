"""A zero that wanders smoothly, wherever it goes."""

import numpy as np

from pipeline.physics.drift import Drift, duration_s
from pipeline.physics.motion import Motion
from pipeline.physics.term import Parameter, Surroundings
from pipeline.physics.waving_drift import shortest_s

PARTS, REACH = 8, 0.8


class SmoothDrift(Drift):
    """d = sum of size_k (cos(k pi t / until) - 1), k = 1 to PARTS, held from `until` on.

    `until` is the recording's end. It is tried where the quickest part is as slow as a wave may be,
    and the rows to fit on go on nearly to the end: after them nothing holds it. Source: the cosine
    series of a smooth function on an interval (Fourier).
    """

    form = "smooth"
    unlikely = 3.0  # as a wave
    says = "The zero wanders to and fro while it runs, slowly, and follows no simple course."

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        span, unit, whole = around.angle_span, around.angle_unit, duration_s(around)
        return (
            *(
                Parameter(f"size_{k}", unit, -span, span, 0.01 * span, 0.03 * span, measured=True)
                for k in range(1, PARTS + 1)
            ),
            Parameter("until", "s", whole, whole, whole, 0.0, weak=True),
        )

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        first = motion.time_s[:1] if state is None else state
        t = np.clip((motion.time_s - first[0]) / values[-1], 0.0, 1.0)
        parts = np.cos(np.pi * np.outer(t, np.arange(1, PARTS + 1))) - 1.0
        return signal + parts @ values[:-1], first

    def scaled(self, values: np.ndarray, factor: float) -> np.ndarray:
        return np.append(values[:-1] * factor, values[-1])

    def void(self, values: np.ndarray) -> bool:
        return not np.any(values[:-1])

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        whole_s = duration_s(around)
        slow = 2.0 * whole_s / PARTS >= shortest_s(around)
        reaches = float(np.ptp(motion.time_s)) > REACH * whole_s
        return slow and reaches and super().excited(motion, around)

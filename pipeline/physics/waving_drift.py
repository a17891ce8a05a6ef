"""A zero that swings slowly: a room through its day."""

from typing import ClassVar

import numpy as np

from pipeline.physics.drift import HOUR_S, Drift, amplitude, duration_s, rate
from pipeline.physics.motion import Motion
from pipeline.physics.term import Parameter, Surroundings

WAVE, RISING = "wave", "rising wave"
SHORTEST, CYCLES = 0.15, 1.5
ALIKE, COINCIDENCE = 0.99, 16.0


class WavingDrift(Drift):
    """d = amplitude (sin(2 pi t / period + phase) - sin phase), slower than the cycles.

    A wave as quick as these is what the commands do. So is one in step with another axis's, unless
    by COINCIDENCE: of all periods and phases those are one in a few thousand. Form "rising wave" is
    the same + rate t: a room that warms up over days. Source: definition.
    """

    unlikely = 3.0  # it follows what jitters by cycle, too
    grows: ClassVar = {WAVE: (RISING,)}

    def __init__(self, form: str = WAVE) -> None:
        self.form = form

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        whole = duration_s(around)
        wave = (
            amplitude(around),
            Parameter("period", "s", shortest_s(around), 3.0 * whole, whole, 0.0),
            Parameter("phase", "rad", -2 * np.pi, 2 * np.pi, 0.0, 0.0),
        )
        return wave if self.form == WAVE else (*wave, rate(around))

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        first = motion.time_s[:1] if state is None else state
        size, period_s, phase, *rising = values
        t = motion.time_s - first[0]
        wave = size * (np.sin(2 * np.pi * t / period_s + phase) - np.sin(phase))
        return signal + (wave + sum(rising) * t / HOUR_S), first

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        size, shortest = 0.01 * around.angle_span, shortest_s(around)
        periods = [p for p in duration_s(around) / np.arange(0.5, 5.0, 0.5) if p >= shortest]
        level = [0.0] * (self.form != WAVE)
        phases = np.arange(4) * np.pi / 4
        return np.array([[size, p, phase, *level] for p in periods for phase in phases])

    def chance(self, values: np.ndarray, motion: Motion) -> float:
        wave = np.sin(2 * np.pi * motion.time_s / values[1] + values[2])
        moving = [other for other in motion.others.values() if np.ptp(other) > 0.0]
        alike = any(abs(np.corrcoef(wave, other)[0, 1]) > ALIKE for other in moving)
        return COINCIDENCE if alike else 0.0

    def void(self, values: np.ndarray) -> bool:
        return bool(values[0] == 0.0)


def shortest_s(around: Surroundings) -> float:
    """The shortest period of a wave [s]: a zero that wanders outlasts CYCLES of them."""
    return duration_s(around) * min(max(SHORTEST, CYCLES / max(around.cycles, 1)), 1.0)

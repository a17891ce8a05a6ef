"""Drift: the zero wanders with time or from cycle to cycle."""

from typing import ClassVar

import numpy as np

from pipeline.physics.motion import Motion
from pipeline.physics.term import Parameter, Surroundings, Term

HOUR_S = 3600.0
SHORTEST, CYCLES = 0.15, 1.5
UNLIKELY = {"wave": 3.0, "rising wave": 3.0, "quadratic": 4.0}
"""A wave follows what jitters by cycle, too; what warms up comes to rest, unlike a parabola."""
SETTLING, QUICKEST_CYCLES, FEWEST = 0.1, 0.3, 5
WARMING = {"exponential": 0.02, "settling": SETTLING}
"""Forms that come to rest, by the shortest time constant [share of the recording]."""


class Drift(Term):
    """seen = theta + d(t), t from the first sample.

    Forms: "linear" d = rate t; "quadratic" d = rate t + acceleration t^2 / 2; "cycle" d = rate n, n
    the number of the cycle; "settling cycle" d = amplitude (1 - exp(-n / constant)); "exponential"
    d = amplitude (1 - exp(-t / tau)), "settling" the same with a tau of at least SETTLING of the
    recording: settled sooner, it is an offset; "wave" d = amplitude (sin(2 pi t / period + phase) -
    sin phase), slower than the cycles: a wave as quick as these is what the commands do; "rising
    wave" the same + rate t: a room that warms up over days. Source: thermal drift of first order;
    definition.
    """

    name = "drift"
    site = "sensor"
    place = 230.0
    adds = True
    slow = True
    grows: ClassVar = {
        "linear": ("quadratic",),
        "cycle": ("settling cycle",),
        "exponential": ("settling cycle",),
        "wave": ("rising wave",),
    }
    means = "the zero wanders with time or from cycle to cycle"
    says = "The zero wanders while it runs."

    def __init__(self, form: str = "linear") -> None:
        self.form = form
        self.evolves = form != "quadratic"  # which runs away where it ends as another course does
        self.unlikely = UNLIKELY.get(form, 0.0)

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        span, unit = around.angle_span, around.angle_unit
        duration = max(around.end_s - around.start_s, 1e-9)
        if self.form == "linear":
            return (rate(span, duration, unit),)
        if self.form == "quadratic":
            most = 4.0 * span * (HOUR_S / duration) ** 2
            bend = Parameter(
                "acceleration", f"{unit}/h^2", -most, most, 0.0, 0.03 * most, measured=True
            )
            return (rate(span, duration, unit), bend)
        if self.form == "cycle":
            most = span / max(around.cycles, 1)
            return (
                Parameter(
                    "rate", f"{unit}/cycle", -most, most, 0.1 * most, 0.03 * most, measured=True
                ),
            )
        amplitude = Parameter(
            "amplitude", unit, -span, span, 0.05 * span, 0.03 * span, measured=True
        )
        if self.form in WARMING:
            quickest = WARMING[self.form] * duration
            tau = Parameter("time_constant", "s", quickest, 2 * duration, duration / 4, 0.0)
            return (amplitude, tau)
        if self.form == "settling cycle":
            most = 2.0 * max(around.cycles, 1)
            return (amplitude, Parameter("constant", "cycles", QUICKEST_CYCLES, most, 2.0, 0.0))
        wave = (
            amplitude,
            Parameter("period", "s", shortest(around), 3.0 * duration, duration, 0.0),
            Parameter("phase", "rad", -2 * np.pi, 2 * np.pi, 0.0, 0.0),
        )
        return wave if self.form == "wave" else (*wave, rate(span, duration, unit))

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        first = np.array([motion.time_s[0], motion.cycle[0]]) if state is None else state
        number = motion.cycle - first[1]
        if self.form == "cycle":
            return signal + values[0] * number, first
        if self.form == "settling cycle":
            return signal - values[0] * np.expm1(-number / values[1]), first
        t = motion.time_s - first[0]
        if self.form in ("linear", "quadratic"):
            hours = t / HOUR_S
            drift = values[0] * hours + 0.5 * sum(values[1:]) * hours**2
        elif self.form in WARMING:
            drift = -values[0] * np.expm1(-t / values[1])
        else:
            drift = values[0] * (np.sin(2 * np.pi * t / values[1] + values[2]) - np.sin(values[2]))
            drift += sum(values[3:]) * t / HOUR_S
        return signal + drift, first

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        duration = max(around.end_s - around.start_s, 1e-9)
        size = 0.01 * around.angle_span
        if self.form in WARMING:
            shares = [s for s in (0.03, 0.1, 0.3, 1.0) if s >= WARMING[self.form]]
            return np.array([[size, s * duration] for s in shares])
        if self.form == "settling cycle":
            return np.array([[size, cycles] for cycles in (1.0, 2.5)])
        if "wave" in self.form:
            periods = [p for p in duration / np.arange(0.5, 5.0, 0.5) if p >= shortest(around)]
            level = [0.0] * (self.form != "wave")
            phases = np.arange(4) * np.pi / 4
            return np.array([[size, p, phase, *level] for p in periods for phase in phases])
        return np.array([[p.start for p in self.parameters(around)]])

    def void(self, values: np.ndarray) -> bool:
        return not np.any(values[: 2 if self.form == "quadratic" else 1])

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        """Form "settling cycle" where there are FEWEST: less show no course from cycle to cycle."""
        shows = self.form != "settling cycle" or around.cycles >= FEWEST
        return shows and around.end_s > around.start_s and len(motion) > 20


def rate(span: float, duration_s: float, unit: str) -> Parameter:
    """How fast a zero moves: over the whole `span` [unit] within a recording at the most."""
    most = span / duration_s * HOUR_S
    return Parameter("rate", f"{unit}/h", -most, most, 0.1 * most, 0.03 * most, measured=True)


def shortest(around: Surroundings) -> float:
    """The shortest period of a wave [s]: a zero that wanders outlasts CYCLES of them."""
    duration = max(around.end_s - around.start_s, 1e-9)
    return duration * min(max(SHORTEST, CYCLES / max(around.cycles, 1)), 1.0)

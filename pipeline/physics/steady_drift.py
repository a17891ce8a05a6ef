"""A zero that goes one way: by the hour, ever faster, or from cycle to cycle."""

from typing import ClassVar

import numpy as np

from pipeline.physics.drift import HOUR_S, Drift, duration_s, rate
from pipeline.physics.motion import Motion
from pipeline.physics.settling_drift import CYCLE, SettlingDrift
from pipeline.physics.term import Parameter, Surroundings, Term


class SteadyDrift(Drift):
    """d = rate t, form "linear"; "quadratic" d = rate t + acceleration t^2 / 2; "cycle" d = rate n.

    n is the number of the cycle. Source: definition.
    """

    grows: ClassVar = {"linear": ("quadratic",)}

    def __init__(self, form: str = "linear") -> None:
        self.form = form
        self.evolves = form != "quadratic"  # which runs away where it ends as another course does
        self.unlikely = 0.0 if self.evolves else 4.0  # what warms up comes to rest

    def richer(self) -> tuple[Term, ...]:
        return (SettlingDrift(CYCLE),) if self.form == "cycle" else super().richer()

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        span, unit = around.angle_span, around.angle_unit
        if self.form == "cycle":
            most = span / max(around.cycles, 1)
            start, typical = 0.1 * most, 0.03 * most
            return (Parameter("rate", f"{unit}/cycle", -most, most, start, typical, measured=True),)
        if self.form == "linear":
            return (rate(around),)
        most = 4.0 * span * (HOUR_S / duration_s(around)) ** 2
        bend = f"{unit}/h^2"
        return (
            rate(around),
            Parameter("acceleration", bend, -most, most, 0.0, 0.03 * most, measured=True),
        )

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        first = np.array([motion.time_s[0], motion.cycle[0]]) if state is None else state
        if self.form == "cycle":
            return signal + values[0] * (motion.cycle - first[1]), first
        hours = (motion.time_s - first[0]) / HOUR_S
        return signal + (values[0] * hours + 0.5 * sum(values[1:]) * hours**2), first

    def void(self, values: np.ndarray) -> bool:
        return not np.any(values)

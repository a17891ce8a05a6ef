"""Drift: the zero wanders with time or from cycle to cycle."""

from pipeline.physics.motion import Motion
from pipeline.physics.term import Parameter, Surroundings, Term

HOUR_S = 3600.0


class Drift(Term):
    """What the courses of the name share: seen = theta + d(t), t from the first sample.

    Each kind of course has a file of its own: steady, settling, waving, and any that is smooth.
    """

    name = "drift"
    site = "sensor"
    place = 230.0
    adds = True
    slow = True
    evolves = True
    means = "the zero wanders with time or from cycle to cycle"
    says = "The zero wanders while it runs."

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        return around.end_s > around.start_s and len(motion) > 20


def amplitude(around: Surroundings) -> Parameter:
    """How far a zero moves: over the whole angle's span at the most."""
    span, unit = around.angle_span, around.angle_unit
    return Parameter("amplitude", unit, -span, span, 0.05 * span, 0.03 * span, measured=True)


def rate(around: Surroundings) -> Parameter:
    """How fast a zero moves: over the angle's span within a recording at the most."""
    most = around.angle_span / duration_s(around) * HOUR_S
    unit = f"{around.angle_unit}/h"
    return Parameter("rate", unit, -most, most, 0.1 * most, 0.03 * most, measured=True)


def duration_s(around: Surroundings) -> float:
    """How long a recording lasts [s]."""
    return max(around.end_s - around.start_s, 1e-9)

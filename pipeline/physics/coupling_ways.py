"""Ways in which another axis's command moves a joint, other than by a gain of its own."""

from dataclasses import dataclass
from typing import ClassVar, Protocol

import numpy as np

from pipeline.physics.held import dwells, trailed
from pipeline.physics.motion import Motion
from pipeline.physics.play_operator import play
from pipeline.physics.term import Parameter, Surroundings

MOST_OF_LEVER = 0.9
STEP_S = 0.5
BRIEFEST_S = 1e-6


@dataclass(frozen=True)
class Scale:
    """Sizes of one coupling: the other command's range [others] and what it may move at most.

    reach: [angle unit/others], of a whole angle range by half of the other's. speed: of the other
    command, usual [others/s].
    """

    span: float
    others: str
    angle: str
    reach: float
    dwell_s: float
    period_s: float

    @property
    def unit(self) -> str:
        return f"{self.angle}/{self.others}"

    @property
    def speed(self) -> float:
        steps = max(self.dwell_s / STEP_S, 1.0)
        return 2.0 * self.span / self.period_s * steps


def scale_of(channel: str, around: Surroundings) -> Scale:
    """The scale of what one other command does."""
    span, dwell_s = max(around.other_span.get(channel, 2.0), 1e-9), max(around.dwell_s, 1e-9)
    others = around.other_unit.get(channel, "deg")
    reach = around.angle_span / (0.5 * span)
    period_s = max(around.period_s, dwell_s)
    return Scale(span, others, around.angle_unit, reach, dwell_s, period_s)


class Way(Protocol):
    """One way. says: its sentence, {it} being the other command. timed: see `Term`.

    shapes: how many of its parameters, the last ones, are no size. starts: rows of parameters to
    begin from, for a gain that is usual.
    """

    says: ClassVar[str]
    shapes: ClassVar[int]
    timed: ClassVar[bool]

    def parameters(self, scale: Scale) -> tuple[Parameter, ...]: ...

    def starts(self, scale: Scale, gain: float) -> np.ndarray: ...

    def pushed(
        self, values: np.ndarray, other: np.ndarray, motion: Motion, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        """The load (n,) by the other command `other` (n,), and what is carried on."""
        ...


class Dragging:
    """drag (v - P(v)), P being the play operator of `width`: v drags along until its wire slips.

    Source: P is that of `backlash.py`, v - P(v) its stop operator (Brokate and Sprekels, Hysteresis
    and Phase Transitions (1996), section 2.3).
    """

    says: ClassVar = (
        "{it} drags this one along by {drag} of the first {width} after each of its reversals."
    )
    shapes: ClassVar = 1
    timed: ClassVar = False

    def parameters(self, scale: Scale) -> tuple[Parameter, ...]:
        span = scale.span
        width = Parameter("width", scale.others, 0.0, 0.9 * span, 0.1 * span, 0.05 * span)
        return (drag_of(scale), width)

    def starts(self, scale: Scale, gain: float) -> np.ndarray:
        drags, widths = (-4.0 * gain, 4.0 * gain), (0.05, 0.15, 0.35)
        return np.array([[drag, share * scale.span] for share in widths for drag in drags])

    def pushed(
        self, values: np.ndarray, other: np.ndarray, motion: Motion, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        drag, width = values
        start = float(other[0]) if state is None else float(state[0])
        slipped = play(np.ascontiguousarray(other), 0.5 * float(width), start)
        return drag * (other - slipped), slipped[-1:]


class Late:
    """drag (v - L(v)), L being a lag of first order: v drags along until that has relaxed.

    v is held through each dwell. drag = -gain is a coupling that comes late as a whole.
    Source: spring and dashpot in series (Maxwell).
    """

    says: ClassVar = (
        "{it} drags this one along by {drag} of each of its steps, and lets go with a time "
        "constant of {time_constant}."
    )
    shapes: ClassVar = 1
    timed: ClassVar = True

    def parameters(self, scale: Scale) -> tuple[Parameter, ...]:
        low, high, start = 0.2 * scale.dwell_s, 0.5 * scale.period_s, 3.0 * scale.dwell_s
        time = Parameter("time_constant", "s", low, max(high, start), start, 0.0)
        return (drag_of(scale), time)

    def starts(self, scale: Scale, gain: float) -> np.ndarray:
        return np.array([[-2.0 * gain, k * scale.dwell_s] for k in (0.8, 2.5)])

    def pushed(
        self, values: np.ndarray, other: np.ndarray, motion: Motion, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        drag, time_constant = values
        last_s, at = (motion.time_s[0], other[0]) if state is None else state
        held, dwell = np.ascontiguousarray(other), dwells(motion, float(last_s))
        late = trailed(held, dwell, float(time_constant), 0.0, float(at), float(at))
        return drag * (other - late), np.array([motion.time_s[-1], late[-1]])


class Cubic:
    """cubic v^3: the next term of the power series.

    Source: an odd load, as of a wire whose lever turns with its own axis, is v and v^3 at first.
    """

    says: ClassVar = "{it} moves this one by {cubic} of its cube."
    shapes: ClassVar = 0
    timed: ClassVar = False

    def parameters(self, scale: Scale) -> tuple[Parameter, ...]:
        most = 4.0 * scale.reach / scale.span**2
        unit = f"{scale.unit}^3"
        return (Parameter("cubic", unit, -most, most, 0.0, 0.02 * most, measured=True),)

    def starts(self, scale: Scale, gain: float) -> np.ndarray:
        size = 4.0 * gain / scale.span**2
        return np.array([[-size], [size]])

    def pushed(
        self, values: np.ndarray, other: np.ndarray, motion: Motion, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        return values[0] * other**3, np.zeros(0)


class Rate:
    """damping v', v' being the mean speed of the step that came last.

    A robot that steps and waits takes as long for each of its steps: STEP_S by convention.
    Source: a damper between the wires; the limit of `Late` where that is brief.
    """

    says: ClassVar = "{it} moves this one by its speed: by {damping}."
    shapes: ClassVar = 0
    timed: ClassVar = True

    def parameters(self, scale: Scale) -> tuple[Parameter, ...]:
        most = 0.5 * scale.reach * scale.span / scale.speed
        start = 0.02 * most
        unit = f"s {scale.unit}"
        return (Parameter("damping", unit, -most, most, start, start, measured=True),)

    def starts(self, scale: Scale, gain: float) -> np.ndarray:
        return np.array([[self.parameters(scale)[0].start]])

    def pushed(
        self, values: np.ndarray, other: np.ndarray, motion: Motion, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        last_s, last = (motion.time_s[0], other[0]) if state is None else state
        moving = np.clip(dwells(motion, float(last_s)), BRIEFEST_S, STEP_S)
        speed = np.diff(other, prepend=last) / moving
        return values[0] * speed, np.array([motion.time_s[-1], other[-1]])


class Lever:
    """1 + lever v + lever_bend v^2 times the joint's angle is seen; no load.

    Source: first terms of the power series by both angles; 1 - cos v where the other axis turns the
    lever out of the plane.
    """

    says: ClassVar = (
        "{it} changes this one's gain, by {lever} of it and {lever_bend} of its square."
    )
    shapes: ClassVar = 0
    timed: ClassVar = False

    def parameters(self, scale: Scale) -> tuple[Parameter, ...]:
        half, unit = 0.5 * scale.span, f"1/{scale.others}"
        most, square = MOST_OF_LEVER / half, MOST_OF_LEVER / half**2
        return (
            Parameter("lever", unit, -most, most, 0.02 * most, 0.02 * most),
            Parameter("lever_bend", f"{unit}^2", -square, square, 0.0, 0.02 * square),
        )

    def starts(self, scale: Scale, gain: float) -> np.ndarray:
        return np.diag([p.typical for p in self.parameters(scale)])

    def pushed(
        self, values: np.ndarray, other: np.ndarray, motion: Motion, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        return np.zeros(len(other)), np.zeros(0)

    def turned(self, values: np.ndarray, other: np.ndarray) -> np.ndarray:
        """By how much the joint's angle is multiplied, (n,)."""
        lever, bend = values
        return np.asarray(1.0 + other * (lever + bend * other))


def drag_of(scale: Scale) -> Parameter:
    """What is dragged along of the other command."""
    reach, usual = scale.reach, 0.05 * scale.reach
    return Parameter("drag", scale.unit, -reach, reach, usual, usual, measured=True)

"""Coupling: another axis's command moves this one."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from pipeline.number_words import worded
from pipeline.physics.balance import Load
from pipeline.physics.coupling_ways import Cubic, Dragging, Late, Lever, Rate, Way, scale_of
from pipeline.physics.held import STEP_AND_WAIT_S
from pipeline.physics.motion import Motion
from pipeline.physics.term import HELD, NO_STATE, Parameter, Surroundings, Term

DIRECT, LEVER, RATE, TORQUE = "/direct", "/lever", "/rate", "/torque"
PLAY, LATE, CUBIC = "/play", "/late", "/cubic"
PLAYING, LAGGING, CURVED = f"{PLAY}{DIRECT}", f"{LATE}{DIRECT}", f"{CUBIC}{DIRECT}"
WAYS: Mapping[str, Way] = {
    PLAYING: Dragging(),
    LAGGING: Late(),
    CURVED: Cubic(),
    PLAY: Dragging(),
    LATE: Late(),
    CUBIC: Cubic(),
    LEVER: Lever(),
    RATE: Rate(),
}
NO_LOAD, BESIDES = (DIRECT, LEVER), (LEVER, RATE)
GROWN: Mapping[str, tuple[str, ...]] = {
    "": (PLAY, LATE, DIRECT, TORQUE),
    PLAY: (LATE, PLAYING),
    LATE: (PLAY, LAGGING),
    DIRECT: (PLAYING, LAGGING),
    PLAYING: (LAGGING,),
    LAGGING: (PLAYING,),
}
OFFERED = ("", DIRECT, LEVER, RATE)
SIZES = 2
UNUSUAL = 6.0  # of twenty couplings one


class Coupling(Term):
    """A load on the joint by the other axis's command v, whose channel is the first part of `form`.

    v counts from that command's zero (`Motion.zeros`), which may be far from 0 in encoder counts.

    Form "channel": gain v + bend v^2. Form "channel/play": what the other wire drags along until it
    slips besides. drag = -gain is a coupling through a wire that has play itself, gain = 0 a
    coupling by that wire's friction alone. Form "channel/late": what it drags along until it has
    relaxed. Form "channel/cubic": its cube besides. In the balance, so that friction, slack and
    contact answer to it; a free joint moves by as much, times the slope of its curve there over the
    mean one: the wires are pulled. It is told as it is at home. Form "channel/torque" is a load on
    the joint itself, which moves a free one by as much wherever it is. Form "channel/direct" is
    none: what the joint stands on is turned by as much; so it is, by a wire that drags, in forms
    "channel/play/direct" and "channel/late/direct", and with its cube in "channel/cubic/direct".
    Beside each of these may stand the forms "channel/rate", what the other axis drags along by its
    speed, and "channel/lever": it changes this one's gain, which is no load either. See
    `coupling_ways.py`. Source: wires of one joint that run through another, first terms of the
    power series.
    """

    name = "coupling"
    site = "body"
    place = 80.0
    means = "another axis's command moves this one"
    says = "The command {other} moves this one too, by {gain} of it."
    says_squared = (
        "The command {other} moves this one too, by {gain} of it and {bend} of its square."
    )

    def __init__(self, form: str = "") -> None:
        self.form = form
        how = next((how for how in (*WAYS, DIRECT, TORQUE) if form.endswith(how)), "")
        self.channel = form.removesuffix(how)
        self.apart = f"of {self.channel}"
        self.way = WAYS.get(how)
        self.pushes = how not in BESIDES
        self.unlikely = UNUSUAL if how.startswith(CUBIC) else 0.0
        self.group = f"{self.name} {self.channel if self.pushes else form}"
        self.in_balance = not how.endswith(NO_LOAD)
        self.timed = self.way is not None and self.way.timed
        if how == LEVER:
            self.beyond_alone = "how far it moves, which the other axis changes without moving it"
        self.only_beside = HELD if how in (DIRECT, TORQUE) else ""

    @property
    def said_by_name(self) -> str:
        return self.channel

    @property
    def kin(self) -> str:
        return self.form.removesuffix(DIRECT).removesuffix(TORQUE)

    def elsewhere(self) -> tuple[Term, ...]:
        return (Coupling(f"{self.form}{DIRECT}"),) if self.form == self.channel else ()

    def richer(self) -> tuple[Term, ...]:
        how = self.form.removeprefix(self.channel)
        return tuple(Coupling(f"{self.channel}{other}") for other in GROWN.get(how, ()))

    @property
    def with_cube(self) -> "Coupling | None":
        """With the cube of the other command in place of what it drags; None of what has none."""
        how = self.form.removeprefix(self.channel)
        if how in ("", PLAY, LATE):
            return Coupling(f"{self.channel}{CUBIC}")
        return Coupling(f"{self.channel}{CURVED}") if how in (DIRECT, PLAYING, LAGGING) else None

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        scale = scale_of(self.channel, around)
        reach, usual, bend = scale.reach, 0.05 * scale.reach, 2.0 * scale.reach / scale.span
        own = (
            Parameter("gain", scale.unit, -reach, reach, usual, usual, measured=True),
            Parameter("bend", f"{scale.unit}^2", -bend, bend, 0.0, 0.02 * bend, measured=True),
        )
        besides = () if self.way is None else self.way.parameters(scale)
        told = (*own, *besides) if self.pushes else besides
        pulls = self.in_balance and not self.form.endswith(TORQUE)
        return tuple(replace(p, at_home=pulls and p.measured) for p in told)

    def told(self, values: np.ndarray, motion: Motion) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The other axis's command from its zero, what gain and bend make of it, the way's values.

        Shapes (n,), (n,) and (w,).
        """
        other = motion.others[self.channel] - motion.zeros.get(self.channel, 0.0)
        if not self.pushes:
            return other, np.zeros(len(other)), values
        return other, other * (values[0] + values[1] * other), values[SIZES:]

    def load(self, values: np.ndarray, motion: Motion, state: np.ndarray | None) -> Load:
        other, pushed, own = self.told(values, motion)
        if self.way is None:
            return Load(torque=pushed) if self.form.endswith(TORQUE) else Load(pushed=pushed)
        besides, carried = self.way.pushed(own, other, motion, state)
        return Load(pushed=pushed + besides, carried=carried)

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        other, pushed, own = self.told(values, motion)
        if self.way is None:
            return signal + pushed, NO_STATE
        if isinstance(self.way, Lever):
            return signal * self.way.turned(own, other), NO_STATE
        besides, carried = self.way.pushed(own, other, motion, state)
        return signal + pushed + besides, carried

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        scale = scale_of(self.channel, around)
        gain = 0.05 * scale.reach
        if self.way is None:
            return np.array([[gain, 0.0], [0.0, 2.0 * gain / scale.span]])
        starts = self.way.starts(scale, gain)
        if not self.pushes:
            return starts
        return np.hstack([np.tile([gain, 0.0], (len(starts), 1)), starts])

    def sizes(self, values: np.ndarray) -> int:
        """How many of its values, the first ones, are sizes."""
        return len(values) - (0 if self.way is None else self.way.shapes)

    def scaled(self, values: np.ndarray, factor: float) -> np.ndarray:
        sizes = self.sizes(values)
        return np.concatenate([factor * values[:sizes], values[sizes:]])

    def void(self, values: np.ndarray) -> bool:
        return not np.any(values[: self.sizes(values)])

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        """A late one where the robot steps and waits: its command is held."""
        held = not isinstance(self.way, Late) or around.dwell_s >= STEP_AND_WAIT_S
        return held and around.other_span.get(self.channel, 0.0) > 0.0

    def sentence(self, values: np.ndarray, around: Surroundings) -> str:
        named = {
            p.name: f"{worded(value)} {p.unit}"
            for p, value in zip(self.parameters(around), values, strict=True)
        }
        other, says = f"The command {self.channel}", ""
        if self.pushes:
            half = 0.5 * around.other_span.get(self.channel, 0.0)
            says = self.says_squared if abs(values[1]) * half > abs(values[0]) else self.says
            says = says.format(other=self.channel, **named)
        if self.way is None:
            return says
        besides = self.way.says.format(it="It" if says else other, **named)
        return f"{says} {besides}".strip()

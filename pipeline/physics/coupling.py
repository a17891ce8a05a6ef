"""Coupling: another axis's command moves this one."""

import numpy as np

from pipeline.number_words import worded
from pipeline.physics.backlash import play
from pipeline.physics.balance import Load
from pipeline.physics.motion import Motion
from pipeline.physics.term import HELD, NO_STATE, Parameter, Surroundings, Term

WITH_PLAY, DIRECT = "/play", "/direct"
SIZES = 3


class Coupling(Term):
    """A load on the joint by the other axis's command v, whose channel is the first part of `form`.

    v counts from that command's zero (`Motion.zeros`), which may be far from 0 in encoder counts.

    Form "channel": gain v + bend v^2. Form "channel/play": drag (v - P(v)) besides, P being the
    play operator of `width`: what the other wire drags along until it slips. drag = -gain is a
    coupling through a wire that has play itself, gain = 0 a coupling by that wire's friction alone.
    In the balance, so that friction, slack and contact answer to it; a free joint moves by as much,
    times the slope of its curve there over the mean one: the wires are pulled. Form
    "channel/direct" is no load: what the joint stands on is turned by as much.
    Source: wires of one joint that run through another, first two terms of the power series; play
    operator as in `backlash.py`, v - P(v) is its stop operator (Brokate and Sprekels, Hysteresis
    and Phase Transitions (1996), section 2.3).
    """

    name = "coupling"
    site = "body"
    place = 80.0
    means = "another axis's command moves this one"
    says = "The command {other} moves this one too, by {gain} of it."
    says_squared = (
        "The command {other} moves this one too, by {gain} of it and {bend} of its square."
    )
    says_with_play = (
        "The command {other} moves this one too, by {gain} of it, and drags it along by {drag} of "
        "the first {width} after each of its reversals."
    )

    def __init__(self, form: str = "") -> None:
        self.form = form
        self.channel = form.removesuffix(WITH_PLAY).removesuffix(DIRECT)
        self.group = f"{self.name} {self.channel}"
        self.plays = form.endswith(WITH_PLAY)
        self.in_balance = not form.endswith(DIRECT)
        self.only_beside = "" if self.in_balance else HELD

    @property
    def kin(self) -> str:
        return self.form.removesuffix(DIRECT)

    def elsewhere(self) -> tuple[Term, ...]:
        return (Coupling(f"{self.form}{DIRECT}"),) if self.form == self.channel else ()

    def richer(self) -> tuple[Term, ...]:
        plain = self.form == self.channel
        return tuple(Coupling(f"{self.form}{how}") for how in (WITH_PLAY, DIRECT) if plain)

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        span = max(around.other_span.get(self.channel, 2.0), 1e-9)
        other = 0.5 * span
        reach = around.angle_span / other
        others = around.other_unit.get(self.channel, "deg")
        unit, bend = f"{around.angle_unit}/{others}", reach / other
        own = (
            Parameter("gain", unit, -reach, reach, 0.05 * reach, 0.05 * reach, measured=True),
            Parameter("bend", f"{unit}^2", -bend, bend, 0.0, 0.02 * bend, measured=True),
        )
        if not self.plays:
            return own
        return (
            *own,
            Parameter("drag", unit, -reach, reach, 0.05 * reach, 0.05 * reach, measured=True),
            Parameter("width", others, 0.0, 0.9 * span, 0.1 * span, 0.05 * span),
        )

    def counted(self, motion: Motion) -> np.ndarray:
        """The other axis's command from its zero, (n,)."""
        return motion.others[self.channel] - motion.zeros.get(self.channel, 0.0)

    def load(self, values: np.ndarray, motion: Motion, state: np.ndarray | None) -> Load:
        other = self.counted(motion)
        pushed = other * (values[0] + values[1] * other)
        if not self.plays:
            return Load(pushed=pushed)
        start = float(other[0]) if state is None else float(state[0])
        slipped = play(np.ascontiguousarray(other), 0.5 * float(values[3]), start)
        return Load(pushed=pushed + values[2] * (other - slipped), carried=slipped[-1:])

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        other = self.counted(motion)
        return signal + other * (values[0] + values[1] * other), NO_STATE

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        gain, span = self.parameters(around)[0].start, around.other_span.get(self.channel, 2.0)
        if not self.plays:
            return np.array([[gain, 0.0], [0.0, 2.0 * gain / max(span, 1e-9)]])
        drags, widths = (-4.0 * gain, 4.0 * gain), (0.05 * span, 0.15 * span, 0.35 * span)
        return np.array([[gain, 0.0, drag, width] for width in widths for drag in drags])

    def scaled(self, values: np.ndarray, factor: float) -> np.ndarray:
        return np.concatenate([factor * values[:SIZES], values[SIZES:]])

    def void(self, values: np.ndarray) -> bool:
        return not np.any(values[:SIZES])

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        return around.other_span.get(self.channel, 0.0) > 0.0

    def sentence(self, values: np.ndarray, around: Surroundings) -> str:
        named = {
            p.name: f"{worded(value)} {p.unit}"
            for p, value in zip(self.parameters(around), values, strict=True)
        }
        squared = abs(values[1]) * 0.5 * around.other_span.get(self.channel, 0.0) > abs(values[0])
        says = self.says_squared if squared else self.says
        return (self.says_with_play if self.plays else says).format(other=self.channel, **named)

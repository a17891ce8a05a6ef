"""Lost steps: the shaft slips at a moment, a jump of the zero."""

from typing import ClassVar

import numpy as np

from pipeline.number_words import worded
from pipeline.physics.backlash import Backlash
from pipeline.physics.motion import Motion
from pipeline.physics.term import NO_STATE, Parameter, Surroundings, Term
from pipeline.physics.transmission_ripple import TransmissionRipple

MOMENTS = 150
BEHIND = {
    " behind ripple": (TransmissionRipple.name, TransmissionRipple.place + 5.0),
    " behind play": (Backlash.group, Backlash.place + 15.0),
}


TIMES = {"once": 1, "twice": 2, "thrice": 3, "fourfold": 4}
TAILS = ("", "_2", "_3", "_4")
FOLLOWS_WALKS = 4.0


class LostSteps(Term):
    """x(t) = u(t) + jump * [t >= time]; jump [drive unit], time [s]; "twice" two of these.

    Forms "thrice" and "fourfold" have as many: a belt that skips teeth now and then. So many follow
    much of what wanders, too, and are that less likely.

    The motor's count no longer belongs to the shaft's angle: a stepper that loses steps, a coupling
    or a set screw that slips. In the forms "behind ripple" and "behind play" the wire slips on its
    pulley, and what is uneven about the shaft, or its play, stays where it was. Source: definition.
    """

    name = "lost_steps"
    site = "actuator"
    before_curve = True
    slow = True
    unlikely = 3.0
    grows: ClassVar = {f"once{place}": (f"twice{place}",) for place in ("", *BEHIND)}
    means = "the shaft slips at a moment: a jump of the zero"
    says = "The shaft slipped by {jump} at {time}, and its zero has been off since."

    def __init__(self, form: str = "once") -> None:
        self.form = form
        times, *behind = form.split(" ", 1)
        self.only_beside, self.place = BEHIND[f" {behind[0]}"] if behind else ("", 10.0)
        self.times = TIMES[times]
        self.scanned = self.times > 1
        self.unlikely = LostSteps.unlikely + FOLLOWS_WALKS * max(self.times - 2, 0)

    @property
    def in_usual_order(self) -> str:
        return self.form.split(" ")[0]

    @property
    def kin(self) -> str:
        return self.in_usual_order

    def elsewhere(self) -> tuple[Term, ...]:
        return () if self.only_beside else tuple(LostSteps(self.form + place) for place in BEHIND)

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        span = around.drive_span
        return tuple(
            p
            for tail in TAILS[: self.times]
            for p in (
                Parameter(f"jump{tail}", around.drive_unit, -span, span, 0.03 * span, 0.03 * span),
                Parameter(
                    f"time{tail}", "s", around.start_s, around.end_s, around.start_s, 0.0, True
                ),
            )
        )

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        out = signal.astype(float)
        for jump, time_s in zip(values[0::2], values[1::2], strict=True):
            out[motion.time_s.searchsorted(time_s) :] += jump
        return out, NO_STATE

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        rows = np.unique(np.linspace(4, len(motion) - 5, MOMENTS).astype(int))
        return self.at_moments(motion.time_s[rows] - 1e-6, around)

    def at_moments(self, times_s: np.ndarray, around: Surroundings) -> np.ndarray:
        size = 0.01 * around.drive_span
        if self.times == 1:
            return np.column_stack([np.full(len(times_s), size), times_s])
        first = [size, 0.5 * (around.start_s + around.end_s)] * (self.times - 1)
        return np.array([[*first, size, t] for t in times_s])

    def resized(self, values: np.ndarray, factor: float) -> np.ndarray:
        return np.array([*values[:-2], factor * values[-2], values[-1]])

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        return len(motion) > 20

    def sentence(self, values: np.ndarray, around: Surroundings) -> str:
        named = {
            p.name: f"{worded(abs(v))} {p.unit}"
            for p, v in zip(self.parameters(around), values, strict=True)
        }
        told = self.says.format(**named)
        if self.times > 1:
            jumps = [f"by {named[f'jump{t}']} at {named[f'time{t}']}" for t in TAILS[: self.times]]
            told = f"The shaft slipped {', '.join(jumps[:-1])} and {jumps[-1]}."
        return told.replace("The shaft", "The wire on its pulley") if self.only_beside else told

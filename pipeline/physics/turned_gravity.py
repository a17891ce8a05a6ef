"""Gravity whose lever another axis turns away."""

from typing import ClassVar

import numpy as np
from numba import njit

from pipeline.number_words import worded
from pipeline.physics.gravity import SAGGING, Gravity
from pipeline.physics.motion import Motion
from pipeline.physics.tabled import waved
from pipeline.physics.term import NO_STATE, Parameter, Surroundings

TURNED, SAGS = "/turned", f" {SAGGING}"
FARTHEST = 0.5 * np.pi
USUAL = 0.7
SWEEPS, PRECISE = 12, 1e-9


@njit(cache=True, fastmath=True, error_model="numpy")
def hung(asked: np.ndarray, weight: np.ndarray, zero: float, radian: float) -> np.ndarray:
    """theta of theta + weight sin(theta / radian - zero) = asked, (n,) each, by Newton's method.

    After a move its error is no more than half the weight over a radian, times the move squared.
    """
    out = np.empty(asked.size)
    for t in range(asked.size):
        at = asked[t]
        for _ in range(SWEEPS):
            sine, cosine = waved(at / radian - zero)
            move = (asked[t] - at - weight[t] * sine) / (1.0 + weight[t] / radian * cosine)
            at += move
            if move * move < PRECISE * radian * radian:
                break
        out[t] = at
    return out


class TurnedGravity(Gravity):
    """theta + deflection (sin(theta - zero) cos(turn v) + sin(zero)) is what a free joint takes.

    v is the other axis's command from its zero, whose channel is the first part of `form`, and
    `turn` v the angle by which it turns the weight out of this axis's plane: of the lever its
    cosine is left there. After the balance. A form that ends in SAGS has no sin(zero), see
    `Gravity`. Source: static moment of a pendulum, projected.
    """

    in_balance = False
    place = 75.0
    grows: ClassVar = {}
    says = (
        "Its own weight bends it by up to {deflection}, depending on how it hangs, less where the "
        "command {other} turns that away."
    )

    def __init__(self, form: str = TURNED) -> None:
        self.form = form
        self.channel = self.goes_by = form.removesuffix(SAGS).removesuffix(TURNED)

    @property
    def kin(self) -> str:
        return ""

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        half = 0.5 * max(around.other_span.get(self.channel, 2.0), 1e-9)
        unit = f"rad/{around.other_unit.get(self.channel, 'deg')}"
        deflection, zero = super().parameters(around)
        usual = USUAL / half
        return (deflection, zero, Parameter("turn", unit, 0.0, FARTHEST / half, usual, usual))

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        weight, zero, turn = values
        left = weight * np.cos(
            turn * (motion.others[self.channel] - motion.zeros.get(self.channel, 0.0))
        )
        home = 0.0 if self.form.endswith(SAGS) else weight * np.sin(zero)
        out = hung(signal - home, left, float(zero), motion.radian)
        return out, NO_STATE

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        turn = self.parameters(around)[2].start
        return np.insert(super().candidates(motion, around), 2, turn, axis=1)

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        turns = around.other_span.get(self.channel, 0.0) > 0.0
        return turns and super().excited(motion, around)

    def sentence(self, values: np.ndarray, around: Surroundings) -> str:
        bent = f"{worded(abs(values[0]))} {around.angle_unit}"
        return self.says.format(deflection=bent, other=self.channel)

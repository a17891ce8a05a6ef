"""Slack: a dead zone around home, without a loop."""

from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from pipeline.physics.backlash import Backlash
from pipeline.physics.balance import Load
from pipeline.physics.compliance import Compliance
from pipeline.physics.driven_slack import DRIVEN, OFF_HOME, DrivenSlack
from pipeline.physics.motion import Motion
from pipeline.physics.soft_wire import SoftWire
from pipeline.physics.term import Parameter, Shown, Surroundings, Term, Told

HOME, BEHIND = "home", "behind"


class Slack(Term):
    """In the balance, both wires hang loose over a width, and beyond it one of them pulls alone.

    Where nothing else loads the joint, nothing moves within half the width of the centre; otherwise
    the load decides on which side it hangs. `stiffness` is the joint's over the wires'. A wire only
    pulls, and its slack ends over `rounding` (see `balance.py`). In form "home" the centre is where
    the drive is 0; in those "behind" the way is lost of the angle asked for, not of the drive.
    Source: dead-zone nonlinearity, Tao and Kokotovic, Adaptive Control of Systems with Actuator and
    Sensor Nonlinearities (1996).
    """

    name = "slack"
    site = "transmission"
    place = 50.0
    in_balance = True
    holds = True
    grows: ClassVar = {HOME: ("", f"{HOME} {BEHIND}"), "": (BEHIND,), f"{HOME} {BEHIND}": (BEHIND,)}
    means = "a dead zone around home, without a loop"
    says = "Around home both wires hang slack: nothing moves over {width} of drive."

    def __init__(self, form: str = "") -> None:
        self.form = form
        self.unlikely = 3.0 if BEHIND in form else 0.0  # chance would decide against one before

    def richer(self) -> tuple[Term, ...]:
        where = {HOME: "", "": f" {OFF_HOME}"}.get(self.form)
        driven = () if where is None else (DRIVEN + where,)
        return (*super().richer(), *(DrivenSlack(form) for form in driven))

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        span, unit = around.drive_span, around.drive_unit
        middle, far = around.drive_low + 0.5 * span, 0.35 * span
        width = Parameter("width", unit, 0.0, 0.8 * span, 0.05 * span, 0.05 * span)
        centre = Parameter("centre", unit, middle - far, middle + far, middle, 0.05 * span)
        others = (
            Parameter("rounding", unit, 1e-4 * span, 0.02 * span, 0.002 * span, 0.0004 * span),
            Parameter("stiffness", "", SOFTEST, 2.0, STIFFNESS, 0.02, weak=True),
        )
        return (width, *others) if HOME in self.form else (width, centre, *others)

    def load(self, values: np.ndarray, motion: Motion, state: np.ndarray | None) -> Load:
        width, *others, rounding, stiffness = values
        centre = others[0] if others else 0.0
        softness = max(rounding, width / MOST_SHARP)
        return Load(loose=(0.5 * width, softness, stiffness, centre, BEHIND in self.form))

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        span, widths = around.drive_span, (0.02, 0.06, 0.15, 0.35)
        if HOME in self.form:
            return np.array([[width * span, 0.002 * span, STIFFNESS] for width in widths])
        middle = around.drive_low + 0.5 * span
        return np.array(
            [
                [width * span, middle + centre * span, 0.002 * span, STIFFNESS]
                for width in widths
                for centre in np.linspace(-CENTRES, CENTRES, apart(width))
            ]
        )

    def other_names(self, values: np.ndarray, around: Surroundings) -> tuple[str, ...]:
        """Play, where the joint has next to no spring of its own: what loads it holds it loose."""
        return (Backlash.name,) if values[-1] <= AS_LITTLE * SOFTEST else ()

    def plainer(self, values: np.ndarray, shown: Shown) -> str:
        """A width not worth a parameter is wire that gives way at first."""
        return self.name if shown.worth(0) else Compliance.name

    def instead(self, values: np.ndarray, motion: Motion, around: Surroundings) -> Sequence[Told]:
        """A toe as soft, where in the middle both wires still pull: they are no more than soft."""
        width, rounding, own = values[0], values[-2], values[-1]
        left = 2.0 / (1.0 + np.exp(min(0.5 * width / max(rounding, 1e-12), FIRM)))
        if left <= LEAST_LEFT:
            return ()
        slope = around.angle_span / around.drive_span
        pull = slope * rounding * (np.log(2.0) - np.log1p(np.exp(-width / rounding)))
        softness = 2.0 * own * (1.0 - left) / left
        toe = [softness, pull / (2.0 * own * np.log(2.0)), own, 2.0 * own]
        return [[(SoftWire("toe"), np.array(toe))]]

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        """Form "home" where the drive passes 0, or comes near it from one side only."""
        near, high = EDGE * around.drive_span, around.drive_low + around.drive_span
        home = around.drive_low - near < 0.0 < high + near
        return around.drive_span > 0.0 and (home or HOME not in self.form)


def slack_as(lost: float) -> tuple[Term, np.ndarray]:
    """Slack that loses as much on either side [drive unit] as wire does that is soft at first."""
    return Slack(HOME), np.array([2.0 * lost, 0.3 * lost, STIFFNESS])


def apart(width: float) -> int:
    """How many places (odd) for a slack of a width leave no gap between them, 5 at least."""
    return max(2 * round(CENTRES / width) + 1, 5)


STIFFNESS, SOFTEST, AS_LITTLE = 0.03, 0.01, 1.001
CENTRES, EDGE = 0.25, 0.05
MOST_SHARP = 400.0
LEAST_LEFT, FIRM = 0.05, 50.0

"""Contact: stiffer beyond an angle on one side."""

from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from pipeline.physics.balance import Load
from pipeline.physics.compliance import Compliance
from pipeline.physics.end_stop import EndStop
from pipeline.physics.motion import Motion
from pipeline.physics.softer_side import SofterSide
from pipeline.physics.term import Parameter, Surroundings, Term, Told

STIFFEST, STEEPEST, GRADUALLY, WIDER = 6.0, 30.0, 0.99, 1.5
AT_HOME, WIDE, SKINS, FIRM = 0.02, 8.0, 3.0, 1.0
SIDES, HARDENING, LOSSY = ("upper", "lower"), "hardening", "lossy"


class Contact(Term):
    """stiffness * skin * log(1 + exp(side * (theta - angle) / skin)) in the balance.

    A spring that is met at an angle, and whose stiffness builds up over `skin` round it. Forms
    "upper" and "lower" are its sides; an "unloading" one pushes so hard that beyond `pretension`
    one of two wires hangs slack; a "hardening" one, as pads and round bodies are, pushes besides by
    `hardening` times the square of its depth. A "lossy" one gives back less than it took, as foam
    and rubber do: let go, it springs back by `flank` times that stiffness, but keeps the share
    `kept` of what it pushes with when it is pressed for the first time. Sources: unilateral spring;
    Hertz (1882), whose power of 1.5 lies between; Walton and Braun, J. Rheology 30 (1986) 949, who
    keep nothing.
    """

    name = "contact"
    site = "body"
    unlikely = 2.0
    in_balance = True
    holds = True
    grows: ClassVar = {
        side: tuple(f"{side} {how}" for how in ("unloading", HARDENING)) for side in SIDES
    }
    also_on_both = (Compliance.name,)  # as where either of two wires hangs slack beyond an angle
    means = "stiffer beyond an angle on one side"
    says = "Beyond {angle} on one side it touches something and gets stiffer."

    def __init__(self, form: str = "upper") -> None:
        self.form = form
        self.remembers = "way" if LOSSY in form else ""

    @property
    def side(self) -> float:
        return 1.0 if self.form.startswith("upper") else -1.0

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        span, unit = around.angle_span, around.angle_unit
        middle = around.angle_low + 0.5 * span
        ends = sorted((middle - 0.2 * self.side * span, middle + 0.6 * self.side * span))
        start = middle + 0.3 * self.side * span
        own = (
            Parameter("stiffness", "", 0.0, STIFFEST, 0.5, 0.5),
            Parameter("angle", unit, ends[0], ends[1], start, 0.0, place=True),
            Parameter("skin", unit, 1e-3 * span, 0.06 * span, 0.005 * span, 0.005 * span),
        )
        if HARDENING in self.form:
            return (
                *own,
                Parameter(HARDENING, f"1/{unit}", 0.0, 10.0 / span, 0.2 / span, 0.2 / span),
            )
        if LOSSY in self.form:
            return (
                *own,
                Parameter("flank", "", 1.0, STEEPEST, 3.0, 0.0),
                Parameter("kept", "", 0.0, 1.0, 0.5, 0.5),
            )
        if "unloading" not in self.form:
            return own
        return (*own, pretension(around, 1e-3))

    def also_at(self, values: np.ndarray, around: Surroundings) -> tuple[str, ...]:
        """Compliance, where it is met at home: there one wire takes over, softer than the other.

        Or about home, if a wire hangs slack soon after.

        An end stop, where the simulation goes only a few skins into it: how stiff it comes to be
        does not show.
        """
        stiffness, angle, skin, *more = values
        end = around.angle_low + (around.angle_span if self.side > 0.0 else 0.0)
        slack = angle
        if "unloading" in self.form and stiffness > 0.0:
            slack += self.side * more[0] / stiffness
        home = AT_HOME * around.angle_span
        low, high = sorted((angle, slack))
        at_home = low - home < 0.0 < high + home and high - low < WIDE * home
        shallow = self.side * (end - angle) < SKINS * skin
        return tuple(n for n, so in ((Compliance.name, at_home), (EndStop.name, shallow)) if so)

    def limit(self, values: np.ndarray, around: Surroundings) -> str:
        """What is stiffer than a contact can be is an end stop."""
        return EndStop.name if values[0] >= STIFFEST else ""

    def instead(self, values: np.ndarray, motion: Motion, around: Surroundings) -> Sequence[Told]:
        """An end stop, met where this is or elsewhere, once it is as stiff as the wire.

        Or a wire that is softer than the other, once it can be met no more gradually, or while it
        is soft, changes twice: as it is met, and as a wire hangs slack.
        """
        skin = self.parameters(around)[2].high
        changes_twice = "unloading" in self.form and values[0] < FIRM
        if values[2] >= GRADUALLY * skin or changes_twice:
            side = SIDES[0] if self.side > 0.0 else SIDES[1]
            return [[(SofterSide(side), np.array([*values[:2], WIDER * max(values[2], skin)]))]]
        if values[0] < FIRM:
            return ()
        stop = EndStop("upper" if self.side > 0.0 else "lower")
        starts = stop.candidates(motion, around)
        return [[(stop, own)] for own in (*starts, np.array([values[1], *starts[0, 1:]]))]

    def void(self, values: np.ndarray) -> bool:
        return bool(values[0] == 0.0 and (HARDENING not in self.form or values[3] == 0.0))

    def load(self, values: np.ndarray, motion: Motion, state: np.ndarray | None) -> Load:
        stiffness, angle, skin, *more = values.tolist()
        if LOSSY in self.form:
            (flank, kept), push = more, self.side * skin * stiffness
            return Load(pad=np.array([[self.side / skin, angle, push, flank * stiffness, kept]]))
        hard = more[0] if HARDENING in self.form else 0.0
        deep = self.side * skin
        contact = np.array([[self.side / skin, angle, deep * stiffness, deep * hard * skin]])
        return Load(contact=contact, pretension=more[0] if "unloading" in self.form else np.inf)

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        middle, span = around.angle_low + 0.5 * around.angle_span, around.angle_span
        tails = [[0.02 * span], [0.08 * span]] if "unloading" in self.form else [[]]
        if HARDENING in self.form:
            tails = [[0.2 / span], [2.0 / span]]
        if LOSSY in self.form:
            tails = [[3.0, 0.3], [10.0, 0.7]]
        return np.array(
            [
                [stiffness, middle + self.side * share * span, 0.005 * span, *tail]
                for tail in tails
                for stiffness in (0.1, 1.0)
                for share in (-0.1, 0.0, 0.08, 0.16, 0.24, 0.32, 0.38, 0.43)
            ]
        )


def pretension(around: Surroundings, least: float) -> Parameter:
    """The load beyond which one of two wires hangs slack, at least a share of the angle's span."""
    span, unit = around.angle_span, around.angle_unit
    return Parameter("pretension", unit, least * span, 0.4 * span, 0.05 * span, 0.05 * span)

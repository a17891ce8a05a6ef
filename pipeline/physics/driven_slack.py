"""Slack before the nominal curve: what the drive turns for nothing, whatever loads the joint."""

from typing import ClassVar

import numpy as np
from numba import njit

from pipeline.physics.backlash import BEHIND_JOINT, Backlash
from pipeline.physics.compliance import Compliance
from pipeline.physics.motion import Motion
from pipeline.physics.term import NO_STATE, Parameter, Shown, Surroundings, Term

FAR = 40.0  # from an end, in roundings: nothing of that is left
OFF_HOME, DRIVEN, AHEAD, JOINT = "off home", "driven", "ahead of play", "of the joint"


@njit(cache=True, error_model="numpy")
def taken_up(signal, centre, half, rounding, kept):  # type: ignore[no-untyped-def]
    """The drive (n,) less what slack about a centre takes up of it, as `DrivenSlack` says."""
    out = np.empty(signal.size)
    for i in range(signal.size):
        lost = -half
        for side in (1.0, -1.0):
            off = (signal[i] - centre + side * half) / rounding
            up = max(off, 0.0)
            if abs(off) < FAR:
                up += np.log1p(np.exp(-abs(off)))
            lost += side * rounding * up
        out[i] = signal[i] - (1.0 - kept) * lost
    return out


class DrivenSlack(Term):
    """x = u - (1 - kept) lost(u - centre), lost(v) = w log((1 + e^((v + h) / w)) / (1 +
    e^((v - h) / w))) - h, with the half width h and the `rounding` w of its ends.

    Of what the drive turns within the width the share `kept` still comes through, as where one of
    two strands hangs loose. No load moves a joint in it: what is loose lies between the motor and
    what holds the wires. In forms "ahead of play" it lies before what plays, elsewhere behind that;
    in those "off home" its middle is another drive than 0. Wider than it is rounded it is a dead
    zone; rounded wider, loss that saturates as tanh(v / 2 w). Source: dead zone at the input, Tao
    and Kokotovic, Adaptive Control of Systems with Actuator and Sensor Nonlinearities (1996); the
    softplus log(1 + e^x) at its ends, Dugas et al., NIPS 13 (2000).
    """

    name = "slack"
    site = "transmission"
    before_curve = True
    own_law = True
    grows: ClassVar = {
        DRIVEN: (f"{DRIVEN} {OFF_HOME}", AHEAD),
        AHEAD: (f"{AHEAD} {OFF_HOME}",),
        f"{DRIVEN} {OFF_HOME}": (f"{AHEAD} {OFF_HOME}",),
    }
    means = "a dead zone around home, without a loop"
    says = "Around home the wires hang slack: {width} of drive are lost before the joint follows."

    def __init__(self, form: str = DRIVEN) -> None:
        self.form = form
        if AHEAD in form:
            self.only_beside, self.place = Backlash.group, Backlash.place - 5.0
            self.unlikely = 1.0  # chance would decide where nothing plays

    @property
    def kin(self) -> str:
        return self.form.replace(AHEAD, DRIVEN)

    def richer(self) -> tuple[Term, ...]:
        links = (LooseLink(),) if self.form == f"{DRIVEN} {OFF_HOME}" else ()
        return (*super().richer(), *links)

    def elsewhere(self) -> tuple[Term, ...]:
        ahead = self.form.replace(DRIVEN, AHEAD)
        return () if ahead == self.form else (DrivenSlack(ahead),)

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        span, low, unit = self.signal(around)
        middle, far = low + 0.5 * span, 0.35 * span
        own = (
            Parameter("width", unit, 0.0, 0.8 * span, 0.05 * span, 0.05 * span),
            Parameter("rounding", unit, 1e-4 * span, 0.05 * span, 0.002 * span, 0.004 * span),
            Parameter("kept", "", 0.0, MOST_KEPT, 0.0, 0.05, weak=True),
        )
        centre = Parameter("centre", unit, middle - far, middle + far, middle, 0.05 * span)
        return own if self.form in (DRIVEN, AHEAD) else (*own, centre)

    def signal(self, around: Surroundings) -> tuple[float, float, str]:
        """Span, lower end and unit of what it acts on."""
        return around.drive_span, around.drive_low, around.drive_unit

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        width, rounding, kept, *centre = values
        asked, middle = np.ascontiguousarray(signal), float(centre[0]) if centre else 0.0
        return taken_up(asked, middle, float(0.5 * width), float(rounding), float(kept)), NO_STATE

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        span, low, _ = self.signal(around)
        rows = [
            [width * span, share * width * span, 0.0]
            for width in (0.01, 0.03, 0.08, 0.2)
            for share in (0.03, 0.2)
        ]
        if self.form in (DRIVEN, AHEAD):
            return np.array(rows)
        middle = low + 0.5 * span
        off = np.linspace(-0.25, 0.25, 9) * span
        return np.array([[*row, middle + centre] for row in rows for centre in off])

    def plainer(self, values: np.ndarray, shown: Shown) -> str:
        """A width not worth a parameter is wire that gives way at first.

        So is what is rounded so wide that even in its middle less is lost than comes through.
        """
        lost = np.tanh(0.25 * values[0] / values[1])
        loose = lost > LEAST_LOST and shown.worth(0, (KEPT,))
        return self.name if loose else Compliance.name

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        """Forms of a middle at home where the drive passes 0."""
        home = around.drive_low < 0.0 < around.drive_low + around.drive_span
        return around.drive_span > 0.0 and (home or self.form not in (DRIVEN, AHEAD))


class LooseLink(DrivenSlack):
    """The same of the joint's angle, whatever the curve: the link hangs loose on what moves it.

    Source: as of slack of the drive.
    """

    form = JOINT
    before_curve = False
    place = BEHIND_JOINT
    far_apart = True
    grows: ClassVar = {}
    says = "The link hangs loose on its joint: around home {width} of its motion are lost."

    def __init__(self) -> None:
        super().__init__(JOINT)

    @property
    def kin(self) -> str:
        return f"{DRIVEN} {OFF_HOME}"

    def signal(self, around: Surroundings) -> tuple[float, float, str]:
        return around.angle_span, around.angle_low, around.angle_unit


MOST_KEPT, LEAST_LOST = 0.6, 0.5
KEPT = 2


def driven_as(lost: float, reach: float, centre: float = 0.0) -> list[tuple[Term, np.ndarray]]:
    """Slack of the drive that loses as much as wire does that is soft at first.

    lost: how much, on either side [drive unit]. reach: over which way [drive unit]. centre: the
    drive in its middle; where that is away from 0 by more than is lost, home is not tried.
    """
    starts = [(2.0 * lost, share * lost, 0.0) for share in (0.1, 0.3, 1.0)]
    starts.append((2.0 * reach, 0.1 * reach, 1.0 - lost / max(reach, 1e-300)))
    if abs(centre) <= lost:
        return [(DrivenSlack(f), np.array(start)) for f in (DRIVEN, AHEAD) for start in starts]
    forms = [DrivenSlack(f"{f} {OFF_HOME}") for f in (DRIVEN, AHEAD)]
    return [(form, np.array([*start, centre])) for form in forms for start in starts]

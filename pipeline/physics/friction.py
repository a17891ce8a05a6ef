"""Wire friction with pre-sliding: a loop with rounded corners, minor loops inside."""

from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from pipeline.physics.backlash import PIN, Backlash
from pipeline.physics.balance import Load
from pipeline.physics.motion import Motion
from pipeline.physics.pre_sliding import ELEMENTS, FASTEST, WIDEST, dragging, reaches_of, weighted
from pipeline.physics.rising_creep import rising_as
from pipeline.physics.slack import HOME, Slack
from pipeline.physics.term import Parameter, Shown, Surroundings, Term, Told

LEFT, LOOSENED, LOOSE = ((0.65, 0.3), (0.5, 0.7)), 1.4, 0.02
SHARP, CORNER, AS_LITTLE = 0.2, 0.01, 1.001
FIRM, ALONE, GIVING, FLANKS = 0.1, 0.1, 0.3, 0.125
WRAPPED, ASYMMETRIC = "wrapped", "driven asymmetric"
ON, ODDS = "driven on", 6.0


class Friction(Term):
    """A distribution of slip elements in the balance at the joint (see `balance.py`).

    Element i yields after reach_i = reach * (1 - spread + spread * e_i), where e_i are the
    quantiles of an exponential distribution with mean 1; all together resist with `width` / 2.
    spread = 0 is one elasto-plastic slider, spread = 1 comes close to Dahl's curve. Forms "bristle"
    and "bristle asymmetric" are one bristle instead (see `pre_sliding.py`): full loops of Dahl's,
    LuGre's at low speed or Bouc and Wen's model look like a bank's, but their small ones drift.
    Form "wrapped" resists with 1 + growth |theta| times as much: a wire that lies round what it
    bends rubs the more the further that is bent (first term of the capstan's power series), and so
    does one that is pulled the more: where it is slack at home, by many times as much.
    Form "driven" is a bristle that the drive bends, x = u - width / 2 z(u), as models of tendons in
    sheaths have it, over no shorter a reach than keeps the joint from moving against the drive; it
    is told by what it holds back at the joint, like the others. In form "driven asymmetric" it is
    held more in one direction than in the other. In form "driven on", over no shorter a reach than
    width / 2, one that lets go faster than it takes hold, as Dahl's does, carries the joint on for
    a while where the drive turns. A distribution of slip elements: see `driven_bank.py`.
    Sources: Euler (1769); Iwan (1966); Al-Bender and Swevers, IEEE Control Systems 28(6) (2008) 64.
    """

    name = "friction"
    site = "transmission"
    place = 60.0
    remembers = "way"
    in_balance = True
    mistaken_for = Backlash.name
    grows: ClassVar = {
        "symmetric": ("asymmetric", "bristle", "bristle asymmetric", "driven", WRAPPED),
        "driven": (ASYMMETRIC,),
    }
    means = "wire friction with pre-sliding: a loop with rounded corners"
    says = (
        "Friction holds the wire back by {width} between the two ways, "
        "and gives way gradually over the first {reach} of motion."
    )

    def __init__(self, form: str = "symmetric") -> None:
        self.form = form
        self.before_curve = form in ("driven", ASYMMETRIC, ON)
        self.unlikely = ODDS if form == ON else 0.0  # what swings carries a joint on as well
        self.in_balance = not self.before_curve

    @property
    def kin(self) -> str:
        return "symmetric" if self.before_curve else self.form

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        unit, driven = around.angle_unit, self.before_curve
        span = around.drive_span if driven else around.angle_span
        own = (
            Parameter("width", unit, 0.0, 0.9 * span, 0.05 * span, 0.05 * span, at_drive=driven),
            Parameter("reach", unit, 1e-3 * span, span, 0.05 * span, 0.05 * span, at_drive=driven),
            Parameter("release", "", 0.0, FASTEST, 0.8, 0.0)
            if "bristle" in self.form or self.before_curve
            else Parameter("spread", "", 0.0, WIDEST, 0.7, 0.3),
        )
        if self.form == WRAPPED:
            far = 0.5 * around.angle_span
            return (*own, Parameter("growth", f"1/{unit}", 0.0, 8.0 / far, 0.5 / far, 2.0 / far))
        if "asymmetric" not in self.form:
            return own
        return (*own, Parameter("asymmetry", "", -0.9, 0.9, 0.0, 0.3))

    def load(self, values: np.ndarray, motion: Motion, state: np.ndarray | None) -> Load:
        width, reach, spread, *others = values.tolist()
        more = others[0] if others else 0.0
        asymmetry, growth = (0.0, more) if self.form == WRAPPED else (more, 0.0)
        if "bristle" in self.form:
            limits = 0.5 * width * (1.0 + asymmetry), 0.5 * width * (1.0 - asymmetry)
            return Load(bristle=np.array([[0.5 * width / reach, *limits, spread]]))
        reaches = reaches_of(reach, spread)
        limit = 0.5 * width / ELEMENTS
        slip = np.empty((ELEMENTS, 4))
        slip[:, 0] = limit / reaches
        slip[:, 1] = limit * (1.0 + asymmetry)
        slip[:, 2] = limit * (1.0 - asymmetry)
        slip[:, 3] = growth
        return Load(slip=slip)

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        width, reach, release = values[:3]
        forward = max(reach, self.least_reach(values))
        share, state = dragging(signal, forward, release, state)
        share = weighted(share, float(values[3]) if self.form == ASYMMETRIC else 0.0)
        return signal - 0.5 * width * share, state

    def least_reach(self, values: np.ndarray) -> float:
        """Of a form that the drive bends: over which it is as firm as that [drive unit]."""
        asymmetry = abs(values[3]) if self.form == ASYMMETRIC else 0.0
        lets_go = 0.0 if self.form == ON else values[2]
        return float(0.5 * values[0] * (1.0 + asymmetry) * (1.0 + lets_go))

    def also_at(self, values: np.ndarray, around: Surroundings) -> tuple[str, ...]:
        """Play, where it gives way by little, or is as firm as the drive that bends it.

        One slider alone that gives way by little is play whose gap a weak spring spans.
        """
        if self.before_curve:
            return (Backlash.name,) if values[1] < self.least_reach(values) else ()
        slider = "bristle" not in self.form and values[2] < ALONE
        little = (GIVING if slider else FIRM) * values[0]
        return (Backlash.name,) if values[1] < little else ()

    def other_names(self, values: np.ndarray, around: Surroundings) -> tuple[str, ...]:
        """Play, where the corners are sharp: its flanks give way a little, too."""
        return (Backlash.name,) if values[1] < FLANKS * values[0] else ()

    def plainer(self, values: np.ndarray, shown: Shown) -> str:
        """Backlash where the corners are surely sharp, or far smaller than the loop is wide."""
        corner = not self.before_curve and values[1] < CORNER * values[0]
        return Backlash.name if corner or shown.sharp(1) else self.name

    def limit(self, values: np.ndarray, around: Surroundings) -> str:
        """Backlash where it gives way over as little as it can."""
        sharpest = self.parameters(around)[1].low
        return Backlash.name if values[1] <= AS_LITTLE * sharpest else ""

    def instead(self, values: np.ndarray, motion: Motion, around: Surroundings) -> Sequence[Told]:
        """Less of it beside slack; for what grows with the bend creep that grows with the pull.

        Friction holds the joint between its loose wires: about as much as these are slack, the loop
        is wider. No small step leads from friction alone to both. What has sharp corners at the
        joint is play in its pin.
        """
        slack = Slack(HOME) if Slack(HOME).excited(motion, around) else Slack()
        (width, reach), slope = values[:2], around.angle_span / around.drive_span
        found: list[Told] = []
        for own, spread in LEFT:
            loose = slack.candidates(motion, around)[0]
            loose[0], loose[-1] = LOOSENED * (1.0 - own) * width / max(slope, 1e-12), LOOSE
            held = np.array([own * width, own * reach, spread])
            found.append([(Friction(), held), (slack, loose)])
        if not self.before_curve and reach < SHARP * width:
            found.append([(Backlash(PIN), values[:1])])
        if self.form == WRAPPED:
            loop = width * (1.0 + values[3] * 0.25 * around.angle_span)
            found += [[told] for told in rising_as(loop / max(slope, 1e-12), around)]
        return found

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        span = around.drive_span if self.before_curve else around.angle_span
        tail = [0.0] if "asymmetric" in self.form else [1.0 / span] if self.form == WRAPPED else []
        return np.array(
            [
                [width * span, reach * span, 0.7, *tail]
                for width in (0.01, 0.04, 0.15)
                for reach in (0.01, 0.04, 0.15)
            ]
        )

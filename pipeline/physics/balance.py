"""The balance at the joint: friction, stretch, gravity, contact and stop meet in one equation.

q = theta + f + give(k theta + f),
f = slips[theta] + arms[theta] + stretch(theta) + gravity(theta) + contacts(theta) - pushed

q is the angle that the wire asks for, theta the angle that the joint takes; every load f is
divided by the stiffness of the wire, so that it is the angle [angle unit] by which the wire gives
way. What a slack or toeing wire gives way besides depends on its whole force, k theta + f, k being
the joint's own stiffness over the wire's. Where f exceeds the wires' pretension, one of the two
hangs slack and the other gives way twice as much. Slips are springs with dry sliders in series
(Iwan, J. Appl. Mech. 33 (1966) 893), bristles bend and let go (`pre_sliding.py`), arms are springs
with dashpots in series (Maxwell). A dashpot beside them, drag theta', holds the joint where it was
when a dwell began; over a dwell of length t it pulls as a spring of stiffness r / (exp(r t / drag)
- 1), which is exact where all else is linear with the stiffness r. `equilibrium.py` solves it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from operator import attrgetter
from typing import TYPE_CHECKING, Protocol, cast

import numpy as np

from pipeline.physics.equilibrium import NEVER, balance
from pipeline.physics.kinematics import Curve
from pipeline.physics.motion import Motion

if TYPE_CHECKING:
    from pipeline.physics.mechanism import Piece

NO_SLIP = np.zeros((0, 3))
NO_BRISTLE = np.zeros((0, 4))
NO_ARM = np.zeros((0, 2))
NO_GIVE = np.zeros((0, 4))
NO_CONTACT = np.zeros((0, 4))
BALANCE = "balance"
TABLES = attrgetter("slip", "bristle", "arm", "contact", "give", "loose")


@dataclass(frozen=True)
class Load:
    """What a term adds to the balance.

    slip: (m, 3) stiffness [1], force limit against rising and against falling [angle unit].
    bristle: (b, 4) stiffness [1], force limits as of a slip, and release [1].
    arm: (a, 2) stiffness [1] and time constant [s] of a spring with a dashpot (Maxwell).
    smooth: (4,) linear [1], cubic [1/angle^2], gravity [angle] and gravity's zero [rad].
    contact: (c, 4) side (+1, -1), angle, stiffness [1], and the depth [angle] over which that
        stiffness builds up round the angle.
    give: (g, 4) most that the wire gives way besides [angle], force at which it does so [angle],
        the joint's own stiffness [1], and the angle at which the wire is slack [angle].
    loose: (l, 4) half the way over which both wires hang slack [drive unit], the softness of its
        ends [drive unit], the joint's own stiffness [1], and the drive in the middle of that way.
    pretension: load beyond which one of two wires hangs slack and the other gives twice [angle].
    drag: viscous load over speed [s]: the time constant of a joint without other loads.
    pushed: (n,) load from outside that moves a free joint by as much [angle]; None where none.
    carried: what the term must know to go on from the last sample.
    """

    slip: np.ndarray = field(default_factory=lambda: NO_SLIP)
    bristle: np.ndarray = field(default_factory=lambda: NO_BRISTLE)
    arm: np.ndarray = field(default_factory=lambda: NO_ARM)
    smooth: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    contact: np.ndarray = field(default_factory=lambda: NO_CONTACT)
    give: np.ndarray = field(default_factory=lambda: NO_GIVE)
    loose: np.ndarray = field(default_factory=lambda: NO_GIVE)
    pretension: float = np.inf
    drag: float = 0.0
    pushed: np.ndarray | None = None
    carried: np.ndarray = field(default_factory=lambda: np.zeros(0))


class BalancedTerm(Protocol):
    """A term that has a load."""

    def load(self, values: np.ndarray, motion: Motion, state: np.ndarray | None) -> Load: ...


def settle(
    asked: np.ndarray,
    pieces: Sequence["Piece"],
    motion: Motion,
    curve: Curve,
    state: np.ndarray | None,
    memory: Mapping[str, np.ndarray],
) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Joint angles, shape (n,), and the states to carry; unstressed at the first sample.

    slope: mean slope of the nominal curve [angle unit/drive unit]. state: the balance's own.
    memory: states of the terms that have one beside it, by their names with forms.
    """
    keys = [f"{p.term.name}/{p.term.form}" for p in pieces]
    loads = [
        cast(BalancedTerm, p.term).load(p.values, motion, memory.get(key))
        for p, key in zip(pieces, keys, strict=True)
    ]
    slip, bristle, arm, contact, give, loose = map(stacked, zip(*map(TABLES, loads), strict=True))
    if len(loose):
        asked = asked + taken_up(loose, motion.drive, curve)
        middle = curve(loose[:, 3])
        loose = loose * [curve.slope, curve.slope, 1.0, 1.0]
        loose[:, 3] = middle
    smooth = [sum(part) for part in zip(*(load.smooth for load in loads), strict=True)]
    pushed = np.zeros(len(asked))
    for load in loads:
        if load.pushed is not None:
            pushed += curve(motion.drive + load.pushed / curve.slope) - curve(motion.drive)
    carried = np.zeros(4 + len(slip) + len(bristle) + len(arm)) if state is None else state.copy()
    drag, dwell = sum(load.drag for load in loads), pushed
    if len(arm) or drag > 0.0:
        dwell = motion.dwell_s if state is None else np.diff(motion.time_s, prepend=carried[0])
    angle = np.empty(len(asked))
    if len(asked):
        pretension = min(NEVER, *(load.pretension for load in loads))
        balance(
            np.ascontiguousarray(asked), pushed, dwell, slip, bristle, arm, float(drag),
            (*(float(x) for x in smooth[1:]), motion.radian, contact), (give, loose, pretension),
            float(smooth[0]), state is None, carried[1:], np.zeros((len(arm), 3)), angle,
        )  # fmt: skip
        carried[0] = motion.time_s[-1]
    states = {key: load.carried for key, load in zip(keys, loads, strict=True) if load.carried.size}
    return angle, {BALANCE: carried, **states}


def taken_up(loose: np.ndarray, drive: np.ndarray, curve: Curve) -> np.ndarray:
    """How much more a wire asks for [angle unit], (n,), where the way that hung slack is behind it.

    That way is lost of the drive, before the curve, while the balance takes it off at the curve's
    mean slope.
    """
    half, middle = loose[0, 0], loose[0, 3]
    lost = np.clip(drive - middle, -half, half)
    return curve(drive - lost) + curve.slope * lost - curve(drive)


def stacked(parts: Sequence[np.ndarray]) -> np.ndarray:
    """All rows of some tables of equal width."""
    if len(parts) == 1:
        return parts[0]
    filled = [part for part in parts if part.size] or parts[:1]
    return filled[0] if len(filled) == 1 else np.concatenate(filled)

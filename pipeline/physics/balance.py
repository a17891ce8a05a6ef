"""The balance at the joint: friction, stretch, gravity, contact and stop meet in one equation.

q = theta + f + give(k theta + f) + x,
f = slips[theta] + arms[theta] + pads[theta] + stretch(theta) + gravity(theta) + contacts(theta)
    - pushed

q is the angle that the wire asks for, theta the angle that the joint takes; every load f is
divided by the stiffness of the wire, so that it is the angle [angle unit] by which the wire gives
way. Beside slack it is that of the one wire that pulls: slack of no width leaves other loads as
they are. What a slack or toeing wire gives way besides depends on its whole force, k theta + f, k
being the joint's own stiffness over the wire's. Where f exceeds the wires' pretension, one of the
two hangs slack and the other gives way twice as much. Slips are springs with dry sliders in series
(Iwan, J. Appl. Mech. 33 (1966) 893), bristles bend and let go (`pre_sliding.py`), arms are springs
with dashpots in series (Maxwell). A dashpot beside them, drag theta', holds the joint where it was
when a dwell began; over a dwell of length t it pulls as a spring of stiffness r / (exp(r t / drag)
- 1), which is exact where all else is linear with the stiffness r. A wire that goes on stretching
under all that it pulls is longer by x, see `stretching.py`. `equilibrium.py` solves it.
"""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple, Protocol, cast

import numpy as np

from pipeline.physics.again import balanced_by_cycle
from pipeline.physics.equilibrium import NEVER, PRECISE, balance
from pipeline.physics.kinematics import Curve
from pipeline.physics.memoryless import FEWEST, crept, settled
from pipeline.physics.motion import Motion
from pipeline.physics.piece import Piece
from pipeline.physics.tabled import FAR

BALANCE = "balance"
FEWEST_CYCLES = 3
SHORTEST, LONGEST = 1e-4, 500.0  # dwells over a drag
Loose = tuple[float, float, float, float, bool]
Toe = tuple[float, float, float, float]
Wires = tuple[float, float, float, float, float, float, float]
Smooth = tuple[float, float, float, float]
Bends = tuple[Any, ...]
Loads = tuple[np.ndarray, np.ndarray, float, float, Bends | None, np.ndarray | None]
"""Sliders, arms (a, 5) with three columns to work in, drag, the softest spring, all that bends,
wires that go on stretching (w, 7) with two columns to work in; None where none does."""
IDEAL: Wires = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)


class Load(NamedTuple):
    """What a term adds to the balance.

    slip: (m, 4) stiffness [1], force limit against rising and against falling [angle unit], and by
        how much all of that grows with the bend where a step begins [1/angle], alike for all.
    bristle: (b, 4) stiffness [1], force limits as of a slip, and release [1].
    arm: (a, 2) stiffness [1] and time constant [s] of a spring with a dashpot (Maxwell).
    wire: (w, 6) share of its pull, over the joint's own stiffness, by which a wire goes on
        stretching, time constant [s], that stiffness over the wire's, alike for all, whether the
        drive runs from one sample to the next (1), or is held through each dwell (0), by how much
        it is longer at the first sample than its pull there would have it [angle], and the share of
        what the simulation asks for by which it says too little. One term has all of them.
    contact: (c, 4) side (+1, -1) over the depth at which its stiffness builds up [1/angle], angle,
        side times stiffness times that depth [angle], and side times what it hardens by times
        that depth squared [angle].
    pad: (p, 5) side over the depth at which its stiffness builds up [1/angle], angle, side times
        stiffness times that depth [angle], stiffness of its flanks [1], and the share of a first
        push that it keeps when it is let go [1].
    give: (g, 4) most that the wire gives way besides [angle], one over the force at which it does
        so [1/angle], the joint's own stiffness [1], and the angle where the wire is slack [angle].
    loose: half the way over which both wires hang slack [drive unit], the softness of its
        ends [drive unit], the joint's own stiffness [1], the drive in the middle of that way, and
        whether that way is lost of the angle asked for, not of the drive; None where none is.
    toe: the stretch by the joint's own stiffness that is in what is asked for [1], that stiffness
        over the wire's [1], the share that a wire lacks of its own at first, and the stretch over
        which that comes [angle]; None where no wire has a toe.
    smooth: linear [1], cubic [1/angle^2], gravity [angle] and gravity's zero [rad].
    pretension: load beyond which one of two wires hangs slack and the other gives twice [angle].
    drag: viscous load over speed [s]: the time constant of a joint without other loads.
    runs: whether what is asked for runs straight from one sample to the next where it drags; else
        it is held through each dwell.
    pushed: (n,) load from outside on the wires that moves a free joint by as much where the
        nominal curve is as steep as its mean [angle]; None where none.
    torque: (n,) the same on the joint, wherever it is [angle]; None where none.
    carried: what the term must know to go on from the last sample.
    """

    slip: np.ndarray = np.zeros((0, 4))
    bristle: np.ndarray = np.zeros((0, 4))
    arm: np.ndarray = np.zeros((0, 2))
    wire: np.ndarray = np.zeros((0, 6))
    contact: np.ndarray = np.zeros((0, 4))
    pad: np.ndarray = np.zeros((0, 5))
    give: np.ndarray = np.zeros((0, 4))
    loose: Loose | None = None
    toe: Toe | None = None
    smooth: Smooth = (0.0, 0.0, 0.0, 0.0)
    pretension: float = np.inf
    drag: float = 0.0
    runs: bool = False
    pushed: np.ndarray | None = None
    torque: np.ndarray | None = None
    carried: np.ndarray = np.zeros(0)


class BalancedTerm(Protocol):
    """A term that has a load."""

    def load(self, values: np.ndarray, motion: Motion, state: np.ndarray | None) -> Load: ...


def settle(
    asked: np.ndarray,
    pieces: Sequence[Piece],
    motion: Motion,
    curve: Curve,
    state: np.ndarray | None,
    memory: Mapping[str, np.ndarray],
) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Joint angles, shape (n,), and the states to carry; unstressed at the first sample.

    slope: mean slope of the nominal curve [angle unit/drive unit]. state: the balance's own.
    memory: states of the terms that have one beside it, by their names with forms.
    """
    loads = [
        cast(BalancedTerm, p.term).load(p.values, motion, memory.get(p.key) if memory else None)
        for p in pieces
    ]
    load = loads[0] if len(loads) == 1 else together(loads)
    linear, cubic, gravity, zero = load.smooth
    if load.loose is not None and not load.loose[-1]:
        half, _, _, middle, _ = load.loose
        asked = asked + curve.spared(motion.drive, middle, half)
    wire = None
    if len(load.wire):
        asked = asked * (1.0 + load.wire[:, 5].sum())
        wire = np.hstack([load.wire[:, :5], np.zeros((len(load.wire), 2))])
    pushed = np.zeros(len(asked))
    if gravity != 0.0:
        pushed -= gravity * np.sin(zero)
    for one in loads:
        if one.pushed is not None:
            pushed += curve(motion.drive + one.pushed / curve.slope) - curve(motion.drive)
        if one.torque is not None:
            pushed += one.torque
    arms, upright = len(load.arm), 3 + len(load.slip)
    pads = upright + len(load.bristle)
    ends = pads + len(load.pad)
    wires = 0 if wire is None else len(wire) + 1
    carried = np.zeros(ends + 1 + arms + wires) if state is None else state.copy()
    if state is None:
        carried[pads:ends] = NEVER
    dwell = pushed
    if arms or wires or load.drag > 0.0:
        dwell = motion.dwell_s if state is None else np.diff(motion.time_s, prepend=carried[0])
    states = {p.key: one.carried for p, one in zip(pieces, loads, strict=True) if one.carried.size}
    running = [p.key for p, one in zip(pieces, loads, strict=True) if one.runs]
    if running and load.drag > 0.0 and len(asked):
        before, states[running[0]] = float(memory.get(running[0], asked)[0]), asked[-1:]
        asked = as_held(asked, dwell, load.drag, before)
    angle = np.empty(len(asked))
    if len(asked):
        smooth = (cubic, gravity, zero, 1.0 / motion.radian)
        bends = bending(load, smooth, curve, (carried[upright:pads], carried[pads:ends]))
        arm = np.empty((arms, 5))
        arm[:, :2] = load.arm
        solve(
            np.ascontiguousarray(asked), pushed, dwell,
            (load.slip, arm, load.drag, linear, bends, wire), carried[1:], angle, motion,
        )  # fmt: skip
        carried[0] = motion.time_s[-1]
    return angle, {BALANCE: carried, **states}


def as_held(asked: np.ndarray, dwell: np.ndarray, drag: float, before: float) -> np.ndarray:
    """What asks as much of a free joint that drags, held through each dwell, (n,).

    asked: (n,) angles from one of which to the next what asks runs straight, `before` at first.
    dwell: (n,) time that each takes [s].
    """
    lags = np.clip(dwell / drag, SHORTEST, LONGEST)
    return asked + (1.0 / np.expm1(lags) - 1.0 / lags) * np.diff(asked, prepend=before)


def together(loads: Sequence[Load]) -> Load:
    """What some loads are together, but for what each pushes and carries."""
    wires = [load.loose for load in loads if load.loose is not None]
    toes = [load.toe for load in loads if load.toe is not None]
    linear = cubic = gravity = zero = 0.0
    wire = loads[0].wire
    for load in loads:
        wire = load.wire if len(load.wire) else wire
        a, b, c, d = load.smooth
        linear, cubic, gravity, zero = linear + a, cubic + b, gravity + c, zero + d
    return Load(
        slip=stacked([load.slip for load in loads]),
        bristle=stacked([load.bristle for load in loads]),
        arm=stacked([load.arm for load in loads]),
        wire=wire,
        contact=stacked([load.contact for load in loads]),
        pad=stacked([load.pad for load in loads]),
        give=stacked([load.give for load in loads]),
        loose=wires[0] if wires else None,
        toe=toes[0] if toes else None,
        smooth=(linear, cubic, gravity, zero),
        pretension=min([load.pretension for load in loads]),
        drag=sum([load.drag for load in loads]),
    )


def solve(
    asked: np.ndarray, pushed: np.ndarray, dwell: np.ndarray, loads: Loads, state: np.ndarray,
    angle: np.ndarray, motion: Motion,
) -> None:  # fmt: skip
    """Joint angles (in place, as `state`): of all samples abreast where none needs the one before.

    Of a joint that remembers, but not for a time, what repeats is worked out once. Arguments: see
    `equilibrium.balance`.
    """
    slip, arm, drag, _, bends, wire = loads
    remembers = bends is not None and (len(bends[8]) > 0 or len(bends[11]) > 0)
    slides = len(slip) > 0 or drag > 0.0 or remembers or wire is not None
    if bends is not None and not slides and len(asked) >= FEWEST:
        if len(arm) == 0 and settled(asked, pushed, loads, state, angle):
            return
        if len(arm) > 0 and crept(asked, pushed, dwell, loads, state, angle):
            return
    begins = motion.cycle_begins
    if len(arm) > 0 or drag > 0.0 or wire is not None or len(begins) < FEWEST_CYCLES + 1:
        balance(asked, pushed, dwell, loads, state, angle)
        return
    states = np.empty((len(begins) - 1, len(state)))
    within = PRECISE * motion.radian
    balanced_by_cycle(asked, pushed, loads, begins, within, states, state, angle)


def bending(
    load: Load, smooth: Smooth, curve: Curve, forces: tuple[np.ndarray, np.ndarray]
) -> Bends | None:
    """All that bends the balance, flat as the compiled loop takes it; None where nothing does.

    smooth: cubic, gravity, its zero, an angle's unit in radians. forces: of bristles and of pads.
    """
    bent, pressed = forces
    straight = load.loose is None and load.toe is None
    pull = IDEAL if straight else pulling(load.loose, load.toe, curve)
    grows = len(load.slip) > 0 and load.slip[0, 3] != 0.0
    many = len(load.give) or len(load.bristle) or len(load.pad)
    curved = smooth[0] or smooth[1] or pull[1] or load.pretension < NEVER or many
    if not (curved or grows or len(load.contact)):
        return None
    free = (NEVER, -NEVER) if curved else untouched(load.contact)
    pretension = min(NEVER, load.pretension)
    return (
        *smooth,
        load.contact,
        load.give,
        pull,
        pretension,
        load.bristle,
        bent,
        free,
        load.pad,
        pressed,
    )


def untouched(contact: np.ndarray) -> tuple[float, float]:
    """Angles between which no contact or stop pushes."""
    low, high = -NEVER, NEVER
    for sharpness, angle in contact[:, :2].tolist():
        edge = angle - FAR / sharpness
        low, high = (low, min(high, edge)) if sharpness > 0.0 else (max(low, edge), high)
    return low, high


def pulling(loose: Loose | None, toe: Toe | None, curve: Curve) -> Wires:
    """How wires pull that are slack or soft at first, in the joint's angles.

    Half the way that they are slack, one over its softness, the joint's own stretch and stiffness,
    the middle of the way, the share that the toe lacks, and its length. Wires that never hang slack
    pull both ways.
    """
    if loose is None:
        return IDEAL if toe is None else (0.0, 1.0, *toe[:2], 0.0, *toe[2:])
    half, softness, own, centre, _ = loose
    slope, middle = abs(curve.slope), float(curve(np.array([centre]))[0])
    stretch, firm, lacks, length = (own, 2.0 * own, *IDEAL[5:]) if toe is None else toe
    return half * slope, 1.0 / (softness * slope), stretch, firm, middle, lacks, length


def stacked(parts: Sequence[np.ndarray]) -> np.ndarray:
    """All rows of some tables of equal width."""
    filled = [part for part in parts if len(part)]
    if len(filled) > 1:
        return np.concatenate(filled)
    return filled[0] if filled else parts[0]

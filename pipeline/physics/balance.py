"""The balance at the joint: friction, stretch, gravity, contact and stop meet in one equation.

q = theta + f + give(k theta + f),
f = slips[theta] + arms[theta] + stretch(theta) + gravity(theta) + contacts(theta) - pushed

q is the angle that the wire asks for, theta the angle that the joint takes; every load f is
divided by the stiffness of the wire, so that it is the angle [angle unit] by which the wire gives
way. What a slack or toeing wire gives way besides depends on its whole force, k theta + f, k being
the joint's own stiffness over the wire's. Where f exceeds the wires' pretension, one of the two
hangs slack and the other gives way twice as much. Slips are springs with dry sliders in series
(Iwan, J. Appl. Mech. 33 (1966) 893), arms are springs with dashpots in series (Maxwell). A
dashpot beside them, drag theta', holds the joint where it was when a dwell began; over a dwell of
length t it pulls as a spring of stiffness r / (exp(r t / drag) - 1), which is exact where all else
is linear with the stiffness r.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol, cast

import numpy as np
from numba import njit

from pipeline.physics.motion import Motion

if TYPE_CHECKING:
    from pipeline.physics.mechanism import Piece

NO_SLIP = np.zeros((0, 3))
NO_ARM = np.zeros((0, 2))
NO_GIVE = np.zeros((0, 4))
NO_CONTACT = np.zeros((0, 4))
BALANCE = "balance"
SWEEPS = 40
PRECISE = 1e-6
FAR = 14.0
LONG, BRIEF, SOFTEST = 300.0, 1e-9, 0.05
SAFE = 16.0
LANES = 8


@dataclass(frozen=True)
class Load:
    """What a term adds to the balance.

    slip: (m, 3) stiffness [1], force limit against rising and against falling [angle unit].
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


@njit(cache=True, fastmath=True, error_model="numpy")
def _stops(at, radian, gravity, zero, contact):  # type: ignore[no-untyped-def]
    """Load of gravity, contacts and stops at an angle, and its slope."""
    load, slope = 0.0, 0.0
    if gravity != 0.0:
        load = gravity * (np.sin(at / radian - zero) + np.sin(zero))
        slope = gravity / radian * np.cos(at / radian - zero)
    for j in range(contact.shape[0]):
        skin = contact[j, 3]
        depth = contact[j, 0] * (at - contact[j, 1]) / skin
        if depth > FAR:
            ramp, steep = depth * skin, 1.0
        elif depth > -FAR:
            bite = np.exp(depth)
            ramp, steep = skin * np.log1p(bite), bite / (1.0 + bite)
        else:
            continue
        load += contact[j, 0] * contact[j, 2] * ramp
        slope += contact[j, 2] * steep
    return load, slope


@njit(cache=True, fastmath=True, error_model="numpy")
def _loose(force, half, softness, slack):  # type: ignore[no-untyped-def]
    """How far two loose wires give beyond stiff ones, and the slope of that by the force.

    Each wire pulls by softness * log(1 + exp((+-e - half) / softness)) / 2, e being how far they
    give; that is solved for e in closed form. slack: exp(-half / softness).
    """
    size = 2.0 * abs(force) / softness
    if size > FAR:
        return (half + abs(force)) * (1.0 if force > 0.0 else -1.0), 1.0
    grown = np.exp(size) - 1.0
    root = np.sqrt(grown * grown + 4.0 * slack * slack * (1.0 + grown))
    x = (grown + root) / (2.0 * slack)
    steep = (1.0 + (grown + 2.0 * slack * slack) / root) / (2.0 * slack)
    give = softness * np.log(x) - abs(force)
    return give if force > 0.0 else -give, 2.0 * (1.0 + grown) / x * steep - 1.0


@njit(cache=True, fastmath=True, error_model="numpy")
def balance(  # type: ignore[no-untyped-def]
    q,
    pushed,
    dwell,
    state,
    slip,
    arm,
    drag,
    smooth,
    radian,
    contact,
    give,
    loose,
    pretension,
    fresh,
):
    """Joint angles for the asked angles `q`, shape (n,), and the state to carry.

    The state is (q - pushed, angle, forces of the sliders, far ends of the arms, stiffness r). A
    sample is taken after its dwell: first the joint moves at once, then the arms relax and it
    settles again.
    Newton's method, held between bounds; where nothing slides, a step ends it that is so short that
    the equation's bend, told from the sample before, moves the angle by less than PRECISE.
    """
    m, arms, gives, looses = slip.shape[0], arm.shape[0], give.shape[0], loose.shape[0]
    padded = -(-m // LANES) * LANES
    force, far = np.zeros(padded), state[2 + m : -1].copy()
    k, up, down = np.zeros(padded), np.zeros(padded), np.zeros(padded)
    force[:m], k[:m], up[:m], down[:m] = state[2 : 2 + m], slip[:, 0], slip[:, 1], -slip[:, 2]
    slack, gone = np.exp(-loose[:, 0] / loose[:, 1]), np.zeros(arms)
    cubic, gravity, zero = smooth[1], smooth[2], smooth[3]
    more = contact.shape[0] > 0 or gravity != 0.0
    out = np.empty(q.size)
    asked, theta, yielding = state[0], state[1], 1.0
    stages, firm = 2 if arms > 0 else 1, 1.0 if fresh else state[-1]
    rigid = smooth[0] + arm[:, 0].sum()
    slope, waited, eased = 1.0, -1.0, -1.0
    first = -1 if fresh and q.size > 0 else 0
    for t in range(first, q.size):
        begin = t < 0
        row = 0 if begin else t
        sliding = 0 if begin else padded
        stiff, pull = smooth[0], pushed[row]
        if not begin:
            stiff = rigid
            for j in range(arms):
                pull += arm[j, 0] * far[j]
        held_back = 0.0
        if drag > 0.0 and not begin:
            held_back = firm / max(np.expm1(min(firm * dwell[t] / drag, LONG)), BRIEF)
            stiff += held_back
            pull += held_back * theta
        now = q[row] + pushed[row]
        at = now if begin else theta + (now - asked) * yielding
        asked = now
        for stage in range(1 if begin else stages):
            if stage == 1:
                if waited != dwell[t] or eased != yielding:
                    waited, eased = dwell[t], yielding
                    for j in range(arms):
                        pace = max(1.0 - arm[j, 0] * yielding, 1e-3)
                        gone[j] = -np.expm1(-pace * waited / arm[j, 1]) / pace
                late = 0.0
                for j in range(arms):
                    moved = (theta - far[j]) * gone[j]
                    late += arm[j, 0] * moved
                    far[j] += moved
                pull += late
                at += late * yielding
            low, high, under, over = -1e300, 1e300, -1.0, 1.0
            for sweep in range(SWEEPS):
                load, steep, before = at * stiff - pull, stiff, slope
                if cubic != 0.0:
                    load += cubic * at * at * at
                    steep += 3.0 * cubic * at * at
                if more:
                    other, steeper = _stops(at, radian, gravity, zero, contact)
                    load += other
                    steep += steeper
                step = at - theta
                for block in range(0, sliding, LANES):
                    for i in range(block, block + LANES):
                        free = force[i] + k[i] * step
                        held = min(max(free, down[i]), up[i])
                        load += held
                        steep += k[i] if free == held else 0.0
                rest, slope, wires = at + load - q[row], 1.0 + steep, 1.0
                for j in range(gives):
                    turned = (give[j, 2] * (at - give[j, 3]) + load) / give[j, 1]
                    if abs(turned) > FAR:
                        rest += give[j, 0] if turned > 0.0 else -give[j, 0]
                        continue
                    left = np.exp(-abs(turned))
                    rest += give[j, 0] * ((1.0 - left) if turned > 0.0 else (left - 1.0))
                    slope += give[j, 0] * left / give[j, 1] * (give[j, 2] + steep)
                    wires += give[j, 0] * left / give[j, 1]
                for j in range(looses):
                    pulled = loose[j, 2] * (at - loose[j, 3]) + load
                    extra, share = _loose(pulled, loose[j, 0], loose[j, 1], slack[j])
                    rest += extra
                    slope += share * (loose[j, 2] + steep)
                    wires += share
                if abs(load) > pretension:
                    rest += load - pretension if load > 0.0 else load + pretension
                    slope += steep
                    wires += 1.0
                slope = max(slope, 0.05)
                yielding = 1.0 / slope
                move = rest * yielding
                if abs(move) < PRECISE:
                    break
                if rest > 0.0:
                    high, over = at, rest
                else:
                    low, under = at, rest
                at -= move
                if at <= low or at >= high:
                    share = 0.5 if sweep % 2 else under / (under - over)
                    at = low + share * (high - low)
                elif (
                    m == 0
                    and SAFE * move * move * abs(slope - before) < PRECISE * abs(step) * slope
                ):
                    break
            firm = max(slope / wires - held_back, SOFTEST)
            for i in range(sliding):
                force[i] = min(max(force[i] + k[i] * (at - theta), down[i]), up[i])
            theta = at
        if begin:
            far[:] = theta
        else:
            out[t] = theta
    after = np.empty(3 + m + arms)
    after[0], after[1] = asked, theta
    after[2 : 2 + m], after[2 + m : -1], after[-1] = force[:m], far, firm
    return out, after


def settle(
    asked: np.ndarray,
    pieces: Sequence["Piece"],
    motion: Motion,
    slope: float,
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
    slip, arm = stacked([load.slip for load in loads]), stacked([load.arm for load in loads])
    give, contact = (
        stacked([load.give for load in loads]),
        stacked([load.contact for load in loads]),
    )
    loose = stacked([load.loose for load in loads])
    if len(loose):
        loose = loose * [slope, slope, 1.0, slope]
    smooth = loads[0].smooth if len(loads) == 1 else np.sum([load.smooth for load in loads], axis=0)
    pushed = np.zeros(len(asked))
    for load in loads:
        if load.pushed is not None:
            pushed += load.pushed
    carried = np.zeros(4 + len(slip) + len(arm)) if state is None else state
    drag, dwell = sum(load.drag for load in loads), pushed
    if len(arm) or drag > 0.0:
        last = motion.time_s[0] if state is None else carried[0]
        dwell = np.diff(motion.time_s, prepend=last)
    angle, after = balance(
        np.ascontiguousarray(asked), pushed, dwell, carried[1:], slip, arm, drag,
        np.array(smooth), motion.radian, contact, give, loose,
        min(load.pretension for load in loads), state is None,
    )  # fmt: skip
    states = {key: load.carried for key, load in zip(keys, loads, strict=True) if load.carried.size}
    return angle, {BALANCE: np.concatenate([motion.time_s[-1:], after]), **states}


def stacked(parts: Sequence[np.ndarray]) -> np.ndarray:
    """All rows of some tables of equal width."""
    filled = [part for part in parts if len(part)] or parts[:1]
    return filled[0] if len(filled) == 1 else np.concatenate(filled)

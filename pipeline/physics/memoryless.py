"""A joint that remembers nothing: each sample of its balance by itself, many of them abreast.

Without sliders, bristles, arms and dashpot, the angle is a function of what is asked. Where it has
one value, it is followed once, from the lowest that is asked to the highest, in steps as long as it
is even (numerical continuation: Allgower and Georg, Introduction to Numerical Continuation Methods
(2003)), and kept as a cubic for each of PARTS. From what that says, Newton's method takes all
samples at once, and again those that moved far: no step waits for another sample's. What arms let
go follows from where the joint is before they do, and so does all that comes later: where it
settles then, which is what is seen, is taken for all samples at once too. `balance.py` has the
equation, `equilibrium.py` the joints that remember.
"""

from typing import Any

import numpy as np
from numba import njit

from pipeline.physics.arms import let_go, pulled, relax
from pipeline.physics.decay import decayed_abreast
from pipeline.physics.equilibrium import (
    LEAST_PULL,
    LEAST_SLOPE,
    NEVER,
    PRECISE,
    SAME_DWELL,
    _rested,
    _settled,
)  # fmt: skip
from pipeline.physics.tabled import FAR, inlined, ramped_abreast, waved

PARTS, WIDEST, UNEVEN, EVEN, FLAT = 512, 32, 0.2, 0.07, 0.02
SWEEPS, LANES, BLOCK = 6, 8, 256
FIRM, FEWEST = 0.1, 500
UNKNOWN = (NEVER, 0.0, 0.0, 0.0)

compiled = njit(  # type: ignore[call-overload]
    cache=True, fastmath=True, error_model="numpy", _nrt=False
)


@compiled
def _root(guess, start, asked, pushed, softest, tangent, bends):  # type: ignore[no-untyped-def]
    """The angle that balances, from a guess and the tangent at a start on; its own tangent."""
    return _rested(guess, start, asked, softest, pushed, tangent, bends)[:2]


@inlined
def _sharpest(softest, bends):  # type: ignore[no-untyped-def]
    """How sharply the balance bends at most [1/angle], or -1 where it may have several answers.

    A weight can outweigh what holds the joint; no other load falls with the angle.
    """
    cubic, gravity, _, unit, contact, give, loose, pretension = bends[:8]
    least, stiff, wires = softest - abs(gravity) * unit, softest, 1.0
    bend = loose[1] + np.sqrt(3.0 * cubic) + abs(gravity) * unit * unit / FIRM
    for j in range(contact.shape[0]):
        stiff += contact[j, 0] * (contact[j, 2] + 2.0 * contact[j, 3])
        bend += abs(contact[j, 0]) * (1.0 if contact[j, 3] == 0.0 else 2.0)
    for j in range(give.shape[0]):
        wires += abs(give[j, 0]) * give[j, 1]
        bend += give[j, 1] * (give[j, 2] + stiff)
    if pretension < NEVER:
        wires += 1.0
    if loose[5] > 0.0:
        bend += loose[5] / ((1.0 - loose[5]) * loose[6])
    if 1.0 + min(least, 0.0) * wires < FIRM or (loose[1] > 0.0 and loose[3] + least < 0.0):
        return -1.0
    return bend


@inlined
def _spanned(q, pushed, low, high):  # type: ignore[no-untyped-def]
    """The lowest and the highest of the asked angles, and the mean push; LANES of them abreast."""
    low[:LANES], high[:LANES], mean = NEVER, -NEVER, 0.0
    for begin in range(0, q.size, LANES):
        begin = min(begin, q.size - LANES)
        for i in range(LANES):
            x = q[begin + i] + pushed[begin + i]
            low[i], high[i] = min(low[i], x), max(high[i], x)
    for i in range(1, LANES):
        low[0], high[0] = min(low[0], low[i]), max(high[0], high[i])
    for push in pushed:
        mean += push / pushed.size
    return low[0], high[0], mean


@inlined
def _followed(low, part, pushed, softest, bends, table, owner):  # type: ignore[no-untyped-def]
    """Cubics of the angle over the parts from the lowest asked angle on; which is whose (in place).

    table: a row for each cubic, in shares of its width: four factors, its first part, and one over
    how many.
    """
    at, tangent = _root(low, low, low - pushed, pushed, softest, UNKNOWN, bends)
    begin, step, row = 0, 1, 0
    while begin < PARTS:
        step = min(step, PARTS - begin)
        asked, wide = low + (begin + step) * part - pushed, step * part
        guess = at + wide * tangent[2]
        new, other = _root(guess, at, asked, pushed, softest, tangent, bends)
        b, e, rise = wide * tangent[2], wide * other[2], new - at
        change = max(abs(e - b), abs(2.0 * rise - b - e)) / (b + e + FLAT * wide)
        if change > UNEVEN and step > 1:
            step //= 2
            continue
        table[row, 0], table[row, 1], table[row, 2] = at, b, 3.0 * rise - 2.0 * b - e
        table[row, 3], table[row, 4], table[row, 5] = b + e - 2.0 * rise, begin, 1.0 / step
        owner[begin : begin + step] = row
        row, begin, at, tangent = row + 1, begin + step, new, other
        if change < EVEN:
            step = min(2 * step, WIDEST)


@inlined
def _loaded(at, pushed, softest, bends, load, steep):  # type: ignore[no-untyped-def]
    """Loads at some angles, and their slopes (in place)."""
    cubic, gravity, zero, unit, contact = bends[:5]
    for t in range(at.size):
        square = cubic * at[t] * at[t]
        load[t] = at[t] * (softest + square) - pushed[t]
        steep[t] = softest + 3.0 * square
    if gravity != 0.0:
        for t in range(at.size):
            sine, cosine = waved(at[t] * unit - zero)
            load[t] += gravity * sine
            steep[t] += gravity * unit * cosine
    for j in range(contact.shape[0]):
        sharpness, angle, force, hard = contact[j, 0], contact[j, 1], contact[j, 2], contact[j, 3]
        for t in range(at.size):
            bite, share = ramped_abreast(sharpness * (at[t] - angle))
            load[t] += bite * (force + hard * bite)
            steep[t] += sharpness * share * (force + 2.0 * hard * bite)


@inlined
def _given(asked, at, bends, load, steep, rest, slope):  # type: ignore[no-untyped-def]
    """What is missing to balance under those loads, and its slope (in place)."""
    give, loose, pretension = bends[5], bends[6], bends[7]
    for t in range(at.size):
        rest[t], slope[t] = at[t] + load[t] - asked[t], 1.0 + steep[t]
    for j in range(give.shape[0]):
        most, sharpness, own, centre = give[j, 0], give[j, 1], give[j, 2], give[j, 3]
        for t in range(at.size):
            turned = (own * (at[t] - centre) + load[t]) * sharpness
            left = decayed_abreast(abs(turned))
            rest[t] += most * ((1.0 - left) if turned > 0.0 else (left - 1.0))
            slope[t] += most * left * sharpness * (own + steep[t])
    if pretension < NEVER:
        for t in range(at.size):
            over = abs(load[t]) - pretension
            rest[t] += max(over, 0.0) if load[t] > 0.0 else -max(over, 0.0)
            slope[t] += steep[t] if over > 0.0 else 0.0
    half, sharpness, own, firm, centre, toe, reach = loose
    if sharpness > 0.0 and toe > 0.0:
        for t in range(at.size):
            turned = at[t] - centre
            stretch = own * turned + load[t] - rest[t]
            up, share = ramped_abreast((stretch - half) * sharpness)
            down, other = ramped_abreast((-stretch - half) * sharpness)
            pull = (up - down) / sharpness
            left = toe * decayed_abreast(abs(pull) / reach)
            taut = max((share + other) * (1.0 - left), LEAST_PULL)
            pull -= np.copysign((toe - left) * reach, pull)
            rest[t] = firm * turned + load[t] - pull
            slope[t] = firm + steep[t] + taut * (slope[t] - steep[t] - own)
    elif sharpness > 0.0 and half * sharpness > FAR:
        for t in range(at.size):
            turned = at[t] - centre
            stretch = own * turned + load[t] - rest[t]
            pull, share = ramped_abreast((abs(stretch) - half) * sharpness)
            taut = max(share, LEAST_PULL)
            rest[t] = firm * turned + load[t] - np.copysign(pull / sharpness, stretch)
            slope[t] = firm + steep[t] + taut * (slope[t] - steep[t] - own)
    elif sharpness > 0.0:
        for t in range(at.size):
            turned = at[t] - centre
            stretch = own * turned + load[t] - rest[t]
            up, share = ramped_abreast((stretch - half) * sharpness)
            down, other = ramped_abreast((-stretch - half) * sharpness)
            taut = max(share + other, LEAST_PULL)
            rest[t] = firm * turned + load[t] - (up - down) / sharpness
            slope[t] = firm + steep[t] + taut * (slope[t] - steep[t] - own)


@compiled
def _step(asked, pushed, softest, bends, sharpest, room, at):  # type: ignore[no-untyped-def]
    """One step of Newton's method for a block of angles, and how many are not there yet (room[2]).

    A step is the last that is short beside how sharply the balance bends, and passes no kink.
    """
    load, steep, rest, slope = room[0], room[1], room[2], room[3]
    _loaded(at, pushed, softest, bends, load, steep)
    _given(asked, at, bends, load, steep, rest, slope)
    kink, precise, left = bends[7], PRECISE / bends[3], 0
    for t in range(at.size):
        move = rest[t] / max(slope[t], LEAST_SLOPE)
        at[t] -= move
        short = abs(move) * min(1.0, 0.5 * abs(move) * sharpest)
        passed = abs(move) * steep[t] > abs(abs(load[t]) - kink)
        rest[t] = abs(move) if passed else short
        left += rest[t] > precise
    return left


@inlined
def _stepped(q, pushed, softest, bends, sharpest, room, places, out):  # type: ignore[no-untyped-def]
    """A step for all angles; how many are not there yet, and which (in `places`)."""
    left, precise = 0, PRECISE / bends[3]
    for begin in range(0, q.size, BLOCK):
        here = slice(begin, min(begin + BLOCK, q.size))
        if _step(q[here], pushed[here], softest, bends, sharpest, room, out[here]) > 0:
            for t in range(out[here].size):
                places[left] = begin + t
                left += room[2, t] > precise
    return left


@inlined
def _again(many, q, pushed, softest, bends, sharpest, room, places, out):  # type: ignore[no-untyped-def]
    """The same for the first so many of `places`."""
    asked, push, at, left = room[4], room[5], room[6], 0
    precise = PRECISE / bends[3]
    for begin in range(0, many, BLOCK):
        size = min(BLOCK, many - begin)
        for i in range(size):
            k = places[begin + i]
            asked[i], push[i], at[i] = q[k], pushed[k], out[k]
        _step(asked[:size], push[:size], softest, bends, sharpest, room, at[:size])
        for i in range(size):
            k = places[begin + i]
            out[k], places[left] = at[i], k
            left += room[2, i] > precise
    return left


@inlined
def _finished(q, pushed, softest, bends, sharpest, room, places, out):  # type: ignore[no-untyped-def]
    """Newton's method for all angles that are nearly there (in place)."""
    left = _stepped(q, pushed, softest, bends, sharpest, room, places, out)
    for _ in range(SWEEPS):
        if left == 0:
            break
        left = _again(left, q, pushed, softest, bends, sharpest, room, places, out)
    for k in places[:left]:
        out[k] = _root(out[k], out[k], q[k], pushed[k], softest, UNKNOWN, bends)[0]


def settled(
    asked: np.ndarray, pushed: np.ndarray, loads: tuple[Any, ...], state: np.ndarray,
    out: np.ndarray,
) -> bool:  # fmt: skip
    """Joint angles `out` for asked angles, (n,) each; False where they may depend on the past.

    Arguments: see `equilibrium.balance`.
    """
    table, room = np.empty((PARTS, 6)), np.empty((7, BLOCK))
    numbers = np.empty(PARTS + len(asked), dtype=np.int64)
    return bool(_settle(asked, pushed, *loads[3:5], table, room, numbers, state, out))


@compiled
def _settle(q, pushed, softest, bends, table, room, numbers, state, out):  # type: ignore[no-untyped-def]
    """The angles and the state (in place), if there is one angle for each sample."""
    sharpest = _sharpest(softest, bends)
    if sharpest < 0.0:
        return False
    low, high, mean = _spanned(q, pushed, room[0], room[1])
    part = max((high - low) * (1.0 + 1e-9) / PARTS, 1e-12)
    owner, places = numbers[:PARTS], numbers[PARTS:]
    _followed(low, part, mean, softest, bends, table, owner)
    for t in range(q.size):
        x = (q[t] + pushed[t] - low) * (1.0 / part)
        k = owner[int(x) & (PARTS - 1)] & (PARTS - 1)
        u = (x - table[k, 4]) * table[k, 5]
        out[t] = table[k, 0] + u * (table[k, 1] + u * (table[k, 2] + u * table[k, 3]))
    _finished(q, pushed, softest, bends, sharpest, room, places, out)
    state[0], state[1], state[2] = q[-1] + pushed[-1], out[-1], 1.0
    return True


def crept(
    asked: np.ndarray, pushed: np.ndarray, dwell: np.ndarray, loads: tuple[Any, ...],
    state: np.ndarray, out: np.ndarray,
) -> bool:  # fmt: skip
    """The same for a joint that remembers nothing but where the far ends of its arms are.

    Where the joint settles after they have crept is not needed to go on from there: only where it
    is before is worked out one sample after the other.
    """
    room, pulls = np.empty((7, BLOCK)), np.empty(len(asked))
    places = np.empty(len(asked), dtype=np.int64)
    return bool(_creep(asked, pushed, dwell, *loads[1:5], room, places, pulls, state, out))


@compiled
def _creep(q, pushed, dwell, arm, drag, softest, bends, room, places, pulls, state, out):  # type: ignore[no-untyped-def]
    """The angles and the state (in place), if there is one angle for each sample."""
    sharpest = _sharpest(softest, bends)
    if sharpest < 0.0:
        return False
    far = state[2:-1]
    asked, at, tangent, stiff = state[0], state[1], UNKNOWN, softest
    if state[-1] == 0.0:
        asked = q[0] + pushed[0]
        at, tangent = _root(asked, asked, q[0], pushed[0], softest, tangent, bends)
        far[:] = at
    eased, relaxed, arm[:, 3] = -1.0, -1.0, NEVER
    last = at
    for t in range(q.size):
        stiff, pull = pulled(softest, pushed[t], far, arm)
        guess = at + (q[t] + pushed[t] - asked) * tangent[2]
        asked = q[t] + pushed[t]
        last, tangent = _settled(guess, last, q[t], stiff, pull, tangent, bends)
        if eased != tangent[3] or abs(dwell[t] - relaxed) > SAME_DWELL * relaxed:
            eased, relaxed = tangent[3], dwell[t]
            let_go(eased, relaxed, arm)
        late = relax(last, far, arm)
        at = last + late * eased
        out[t], pulls[t] = at, pull + late
    _finished(q, pulls, stiff, bends, sharpest, room, places, out)
    state[0], state[1], state[-1] = asked, out[-1], 1.0
    return True

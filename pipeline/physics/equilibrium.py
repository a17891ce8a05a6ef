"""The equilibrium at the joint, sample by sample: compiled, see `balance.py` for its equation.

While a joint moves one way, a slider either sticks, and is a spring, or slides, and is a constant
load: all of them together are one straight line, which changes only where the joint turns or
where the next slider begins to slide. A bristle is a curved line. What is left is a smooth equation
for one angle.
"""

import numpy as np
from numba import njit

from pipeline.physics.pre_sliding import bristled

SWEEPS = 40
PRECISE = 1e-6
FAR = 14.0
LONG, BRIEF, SOFTEST = 300.0, 1e-9, 0.05
LEAST_PULL, LEAST_SLOPE = 1e-12, 1e-3
SAFE = 16.0
NEVER = 1e300
SAME_DWELL = 1e-9
EVEN = 0.8
FIRST_PART, GROWTH = 0.04, 1.6
NEARBY = 0.01

# Nothing here allocates an array, so that nothing needs to count references to one (half the time).
inlined = njit(  # type: ignore[call-overload]
    cache=True, fastmath=True, error_model="numpy", forceinline=True, _nrt=False
)


@inlined
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


@inlined
def _wires(at, load, steep, give, pretension):  # type: ignore[no-untyped-def]
    """How far the wires give way under a load besides, its slope by the angle, and by the load."""
    more, slope, wires = 0.0, 0.0, 0.0
    for j in range(give.shape[0]):
        turned = (give[j, 2] * (at - give[j, 3]) + load) / give[j, 1]
        if abs(turned) > FAR:
            more += give[j, 0] if turned > 0.0 else -give[j, 0]
            continue
        left = np.exp(-abs(turned))
        more += give[j, 0] * ((1.0 - left) if turned > 0.0 else (left - 1.0))
        slope += give[j, 0] * left / give[j, 1] * (give[j, 2] + steep)
        wires += give[j, 0] * left / give[j, 1]
    if abs(load) > pretension:
        more += load - pretension if load > 0.0 else load + pretension
        slope += steep
        wires += 1.0
    return more, slope, wires


@inlined
def _loose(stretch, half, softness):  # type: ignore[no-untyped-def]
    """What two loose wires pull by that are stretched so far, and the slope of that.

    Each pulls by softness * log(1 + exp((+-stretch - half) / softness)) / 2.
    """
    size = (abs(stretch) - half) / softness
    if size > FAR:
        pull, slope = 0.5 * softness * size, 0.5
    elif size > -FAR:
        bite = np.exp(size)
        pull, slope = 0.5 * softness * np.log1p(bite), 0.5 * bite / (1.0 + bite)
    else:
        pull, slope = 0.0, 0.0
    other = -(abs(stretch) + half) / softness
    if other > -FAR:
        bite = np.exp(other)
        pull -= 0.5 * softness * np.log1p(bite)
        slope += 0.5 * bite / (1.0 + bite)
    return pull if stretch > 0.0 else -pull, max(slope, LEAST_PULL)


@inlined
def _rested(at, theta, asked, stiff, pull, tangent, body, strings):  # type: ignore[no-untyped-def]
    """The angle at which all loads balance, and its tangent.

    Newton's method from `at`, held between bounds; a step ends it that is so short that the
    equation's bend, told from the slope before at `theta`, moves the angle by less than PRECISE.
    Where wires hang loose, it is the equation of their pull, which never gets steep.
    """
    cubic, gravity, zero, radian, contact, bristle, bent = body
    give, loose, pretension = strings
    low, high, under, over = -NEVER, NEVER, -1.0, 1.0
    slope, yielding = tangent[0], tangent[1]
    wires, taut = 0.0, 1.0
    for sweep in range(SWEEPS):
        load, steep = at * stiff - pull, stiff
        if cubic != 0.0:
            load += cubic * at * at * at
            steep += 3.0 * cubic * at * at
        if contact.shape[0] > 0 or gravity != 0.0:
            other, steeper = _stops(at, radian, gravity, zero, contact)
            load += other
            steep += steeper
        for j in range(bristle.shape[0]):
            stiffness, up, down, release = (
                bristle[j, 0],
                bristle[j, 1],
                bristle[j, 2],
                bristle[j, 3],
            )
            other, steeper = bristled(bent[j], at - theta, stiffness, up, down, release)
            load += other
            steep += steeper
        more, softer, wires = _wires(at, load, steep, give, pretension)
        rest, last, slope = at + load + more - asked, slope, 1.0 + steep + softer
        if loose.shape[0] > 0:
            pulled = loose[0, 2] * (at - loose[0, 3]) + load
            pulling, taut = _loose(pulled - rest, loose[0, 0], loose[0, 1])
            rest, slope = pulled - pulling, (loose[0, 2] + steep) * (1.0 - taut) + taut * slope
        slope = max(slope, LEAST_SLOPE)
        if slope != last:
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
        elif contact.shape[0] > 0 and abs(move) > contact[0, 3]:
            continue
        elif SAFE * move * move * abs(slope - last) < PRECISE * abs(at + move - theta) * slope:
            break
    return at, (slope, yielding, taut * yielding, (1.0 + taut * wires) * yielding)


@inlined
def _line(way, at, ends, slip):  # type: ignore[no-untyped-def]
    """Sliders as one spring for motion this way from `at`: way, stiffness, load at 0, its end."""
    stiff, load, near = 0.0, 0.0, way * NEVER
    for i in range(slip.shape[0]):
        load += slip[i, 1] if way > 0.0 else -slip[i, 2]
        if way * (ends[i] - at) > 0.0:
            stiff += slip[i, 0]
            load -= slip[i, 0] * ends[i]
            near = min(near, ends[i]) if way > 0.0 else max(near, ends[i])
    return way, stiff, load, near


@inlined
def _turn(way, at, ends, slip):  # type: ignore[no-untyped-def]
    """Where each slider will slide (in place) when a joint that came this way to `at` turns."""
    for i in range(slip.shape[0]):
        reached = max(ends[i], at) if way > 0.0 else min(ends[i], at)
        if slip[i, 0] > 0.0:
            ends[i] = reached - way * (slip[i, 1] + slip[i, 2]) / slip[i, 0]


@inlined
def _ends(way, at, forces, slip):  # type: ignore[no-untyped-def]
    """Forces of the sliders at an angle become the angles at which they slide (in place)."""
    for i in range(slip.shape[0]):
        limit = slip[i, 1] if way > 0.0 else -slip[i, 2]
        forces[i] = at + (limit - forces[i]) / slip[i, 0] if slip[i, 0] > 0.0 else at


@inlined
def _forces(way, at, ends, slip):  # type: ignore[no-untyped-def]
    """The other way round."""
    for i in range(slip.shape[0]):
        limit = slip[i, 1] if way > 0.0 else -slip[i, 2]
        ends[i] = limit - way * slip[i, 0] * max(way * (ends[i] - at), 0.0)


@inlined
def _moved(at, theta, asked, stiff, pull, tangent, body, strings, straight, bank, slip, ends):  # type: ignore[no-untyped-def]
    """As `_rested`, with sliders: the joint turns, or one after the other of them slides."""
    turned = False
    while True:
        way, stuck, held, near = bank
        if straight:
            slope = 1.0 + stiff + stuck
            if slope != tangent[0]:
                tangent = (slope, 1.0 / slope, 1.0 / slope, 1.0 / slope)
            at = (asked + pull - held) * tangent[1]
            if slip.shape[0] == 0:
                break
        else:
            at, tangent = _rested(
                at, theta, asked, stiff + stuck, pull - held, tangent, body, strings
            )
        if way * (at - near) > 0.0:
            bank = _line(way, near, ends, slip)
        elif way * (at - theta) < 0.0 and not turned and slip.shape[0] > 0:
            turned = True
            _turn(way, theta, ends, slip)
            bank = _line(-way, theta, ends, slip)
        else:
            break
    return at, tangent, bank


@inlined
def _straight(body, strings):  # type: ignore[no-untyped-def]
    """Whether nothing bends the equation but sliders."""
    bent = body[0] != 0.0 or body[1] != 0.0 or body[4].shape[0] > 0
    bent = bent or body[5].shape[0] > 0
    return not bent and strings[0].shape[0] + strings[1].shape[0] == 0 and strings[2] >= NEVER


@inlined
def _bend(step, bristle, bent):  # type: ignore[no-untyped-def]
    """Forces of the bristles (in place) after a step of the joint."""
    for j in range(bristle.shape[0]):
        stiffness, up, down, release = bristle[j, 0], bristle[j, 1], bristle[j, 2], bristle[j, 3]
        bent[j] = bristled(bent[j], step, stiffness, up, down, release)[0]


@inlined
def _pulled(stiff, pull, far, arm):  # type: ignore[no-untyped-def]
    """Stiffness and pull with those of the arms."""
    for j in range(arm.shape[0]):
        stiff += arm[j, 0]
        pull += arm[j, 0] * far[j]
    return stiff, pull


@inlined
def _power(x, known):  # type: ignore[no-untyped-def]
    """exp(x), with known = (y, exp(y)) of a y nearby; and that. Dwells differ little: a series."""
    more = x - known[0]
    if abs(more) > NEARBY:
        known, more = (x, np.exp(x)), 0.0
    series = 1.0 + more * (1.0 + more / 2.0 * (1.0 + more / 3.0 * (1.0 + more / 4.0)))
    return known[1] * series, known


@inlined
def _let_go(eases, dwell, arm, gone):  # type: ignore[no-untyped-def]
    """Share of its stretch that each arm loses over a dwell, and what tells it (in place)."""
    for j in range(arm.shape[0]):
        pace = max(1.0 - arm[j, 0] * eases, 1e-3)
        left, known = _power(-pace * dwell / arm[j, 1], (gone[j, 1], gone[j, 2]))
        gone[j, 0], gone[j, 1], gone[j, 2] = (1.0 - left) / pace, known[0], known[1]


@inlined
def _relax(theta, far, arm, gone):  # type: ignore[no-untyped-def]
    """Load that the arms let go; their far ends move (in place)."""
    late = 0.0
    for j in range(arm.shape[0]):
        moved = (theta - far[j]) * gone[j, 0]
        late += arm[j, 0] * moved
        far[j] += moved
    return late


@njit(cache=True, fastmath=True, error_model="numpy", _nrt=False)  # type: ignore[call-overload]
def balance(  # type: ignore[no-untyped-def]
    q, pushed, dwell, slip, bristle, arm, drag, body, strings, softest, fresh, state, gone, out
):
    """Joint angles `out` for the asked angles `q`, (n,) each, and the state to carry (in place).

    state: q + pushed, angle, forces of the sliders and of the bristles, far ends of the arms,
    stiffness r. A sample is taken after its dwell: first the joint moves at once, then the arms
    relax and it settles again. Where the stiffness r changes on the way, by more than EVEN, a joint
    with drag goes it again in parts of the dwell, each with its own r.
    body: cubic, gravity, its zero, radian, contacts. strings: gives, loose wires, pretension. gone:
    (a, 3) zeros to work in. A tangent is the equation's slope, one over it, and how far the joint
    moves for what is asked and for a load.
    """
    m, arms = slip.shape[0], arm.shape[0]
    n = m + bristle.shape[0]
    ends, bent, far = state[2 : 2 + m], state[2 + m : 2 + n], state[2 + n : -1]
    alone, body = (*body, bristle[:0], bent), (*body, bristle, bent)
    straight = _straight(body, strings)
    tangent, asked, theta, firm = (1.0, 1.0, 1.0, 1.0), state[0], state[1], state[-1]
    if fresh:
        asked, firm = q[0] + pushed[0], 1.0
        theta, tangent = _rested(asked, asked, q[0], softest, pushed[0], tangent, alone, strings)
        far[:] = theta
    _ends(1.0, theta, ends, slip)
    bank = _line(1.0, theta, ends, slip)
    eased, relaxed, firmer, waited, held_back = -1.0, -1.0, -1.0, -1.0, 0.0
    gone[:, 1], known = NEVER, (NEVER, 0.0)
    for t in range(q.size):
        free, load = _pulled(softest, pushed[t], far, arm)
        now = q[t] + pushed[t]
        at, asked, last = theta + (now - asked) * tangent[2], now, theta
        if drag > 0.0:
            before, began, wait, left, whole = bank, firm, dwell[t], 0.0, True
            while True:
                if firm != firmer or abs(wait - waited) > SAME_DWELL * waited:
                    firmer, waited = firm, wait
                    grown, known = _power(min(firm * waited / drag, LONG), known)
                    held_back = firm / max(grown - 1.0, BRIEF)
                stiff, pull, start = free + held_back, load + held_back * theta, theta
                theta, tangent, bank = _moved(
                    at, theta, q[t], stiff, pull, tangent, body, strings, straight, bank, slip, ends
                )
                firm = max(1.0 / tangent[3] - held_back, SOFTEST)
                if whole and not EVEN * began < firm < began / EVEN:
                    if bank[0] != before[0]:
                        _turn(bank[0], last, ends, slip)
                    at, theta, bank, firm = last, last, before, began
                    whole, left, wait = False, wait, FIRST_PART * wait
                    continue
                _bend(theta - start, bristle, bent)
                if whole:
                    break
                left -= wait
                if left <= 0.0:
                    break
                at, wait = theta, min(GROWTH * wait, left)
        else:
            stiff, pull = free, load
            theta, tangent, bank = _moved(
                at, theta, q[t], stiff, pull, tangent, body, strings, straight, bank, slip, ends
            )
            _bend(theta - last, bristle, bent)
        if arms > 0:
            if eased != tangent[3] or abs(dwell[t] - relaxed) > SAME_DWELL * relaxed:
                eased, relaxed = tangent[3], dwell[t]
                _let_go(eased, relaxed, arm, gone)
            late = _relax(theta, far, arm, gone)
            at, pull, last = theta + late * eased, pull + late, theta
            theta, tangent, bank = _moved(
                at, theta, q[t], stiff, pull, tangent, body, strings, straight, bank, slip, ends
            )
            _bend(theta - last, bristle, bent)
            if drag > 0.0:
                firm = max(1.0 / tangent[3] - held_back, SOFTEST)
        out[t] = theta
    _forces(bank[0], theta, ends, slip)
    state[0], state[1], state[-1] = asked, theta, firm

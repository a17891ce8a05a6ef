"""The equilibrium at the joint, sample by sample: compiled, see `balance.py` for its equation.

While a joint moves one way, a slider either sticks, and is a spring, or slides, and is a constant
load: all of them together are one straight line, which changes only where the joint turns or
where the next slider begins to slide. A bristle is a curved line. What is left is a smooth equation
for one angle, or, where nothing bends (`bends` is None, compiled apart), a line.
"""

from numba import njit

from pipeline.physics.arms import let_go, power, pulled, relax
from pipeline.physics.decay import decayed
from pipeline.physics.pre_sliding import bristled
from pipeline.physics.stretching import (
    begin,
    held_through,
    lengthen,
    lengthening,
    longer_by,
    slots,
    softened,
    softness,
)
from pipeline.physics.tabled import inlined, ramped, waved

SWEEPS, PATIENCE = 40, 8
PRECISE = 2e-8  # of a radian
LONG, BRIEF, SOFTEST = 300.0, 1e-9, 0.05
LEAST_PULL, LEAST_SLOPE = 1e-12, 1e-3
SAFE = 16.0
NEVER = 1e300
SAME_DWELL = 1e-9
EVEN = 0.8
FIRST_PART, GROWTH = 0.04, 1.6
STRAIGHT = (1.0, 1.0, 1.0, 1.0)


@inlined
def _stops(at, unit, gravity, zero, contact):  # type: ignore[no-untyped-def]
    """Load of gravity (but for what it is at 0), contacts and stops at an angle, and its slope."""
    load, slope = 0.0, 0.0
    if gravity != 0.0:
        sine, cosine = waved(at * unit - zero)
        load, slope = gravity * sine, gravity * unit * cosine
    for j in range(contact.shape[0]):
        sharpness, force, hard = contact[j, 0], contact[j, 2], contact[j, 3]
        bite, steep = ramped(sharpness * (at - contact[j, 1]))
        load += bite * (force + hard * bite)
        slope += sharpness * steep * (force + 2.0 * hard * bite)
    return load, slope


@inlined
def _loose(stretch, half, sharpness):  # type: ignore[no-untyped-def]
    """What two loose wires pull by that are stretched so far, and the slope of that.

    Each pulls by log(1 + exp((+-stretch - half) * sharpness)) / sharpness: where half is 0, both
    together by their stretch.
    """
    if half == 0.0:
        return stretch, 1.0
    up, steep = ramped((stretch - half) * sharpness)
    down, steeper = ramped((-stretch - half) * sharpness)
    return (up - down) / sharpness, max(steep + steeper, LEAST_PULL)


@inlined
def _wires(at, load, steep, give, pretension):  # type: ignore[no-untyped-def]
    """How far the wires give way under a load besides, its slope by the angle, and by the load."""
    more, slope, wires = 0.0, 0.0, 0.0
    for j in range(give.shape[0]):
        turned = (give[j, 2] * (at - give[j, 3]) + load) * give[j, 1]
        left = decayed(abs(turned))
        more += give[j, 0] * ((1.0 - left) if turned > 0.0 else (left - 1.0))
        slope += give[j, 0] * left * give[j, 1] * (give[j, 2] + steep)
        wires += give[j, 0] * left * give[j, 1]
    if abs(load) > pretension:
        more += load - pretension if load > 0.0 else load + pretension
        slope += steep
        wires += 1.0
    return more, slope, wires


@inlined
def _padded(pressed, start, at, pad):  # type: ignore[no-untyped-def]
    """How a pad pushes at an angle that was pressed so hard at the start, and the slope of that.

    It follows its stiff flank, but pushes no more than one that is pressed for the first time, and
    no less than the share of that which it keeps.
    """
    sharpness, force, flank, kept = pad[0], pad[2], pad[3], pad[4]
    bite, steep = ramped(sharpness * (at - pad[1]))
    most, steepest = abs(force) * bite, sharpness * force * steep
    side = 1.0 if force > 0.0 else -1.0
    push, slope = pressed + side * flank * (at - start), flank
    if push > most:
        push, slope = most, steepest
    elif push < kept * most:
        push, slope = kept * most, kept * steepest
    return side * push, slope


@inlined
def _missing(at, start, asked, stiff, pull, bends):  # type: ignore[no-untyped-def]
    """What is missing to balance at an angle, its slope, how taut the wires are, their give.

    Where wires hang loose, it is the equation of their pull, which never gets steep.
    """
    cubic, gravity, zero, unit, contact, give, loose, pretension, bristle, bent, _ = bends[:11]
    pad, pressed, soft = bends[11], bends[12], softness(bends)
    load, steep = at * stiff - pull, stiff
    if cubic != 0.0:
        load += cubic * at * at * at
        steep += 3.0 * cubic * at * at
    if contact.shape[0] > 0 or gravity != 0.0:
        other, steeper = _stops(at, unit, gravity, zero, contact)
        load += other
        steep += steeper
    for j in range(bristle.shape[0]):
        stiffness, up, down, release = bristle[j, 0], bristle[j, 1], bristle[j, 2], bristle[j, 3]
        other, steeper = bristled(bent[j], at - start, stiffness, up, down, release)
        load += other
        steep += steeper
    for j in range(pad.shape[0]):
        other, steeper = _padded(pressed[j], start, at, pad[j])
        load += other
        steep += steeper
    more, softer, wires = _wires(at, load, steep, give, pretension)
    rest, slope, taut = at + load + more - asked, 1.0 + steep + softer, 1.0
    rest, slope = rest + soft * at, slope + soft
    half, sharpness, own, firm, centre, toe, reach = loose
    if sharpness > 0.0:
        pulling, taut = _loose(own * (at - centre) + load - rest, half, sharpness)
        if toe > 0.0 and pulling != 0.0:
            left = toe * decayed(abs(pulling) / reach)
            taut = max(taut * (1.0 - left), LEAST_PULL)
            pulling -= (toe - left) * reach if pulling > 0.0 else (left - toe) * reach
        rest = firm * (at - centre) + load - pulling
        slope = firm + steep + taut * (slope - steep - own)
    return rest, max(slope, LEAST_SLOPE), taut, wires


@inlined
def _rested(at, start, asked, stiff, pull, tangent, bends):  # type: ignore[no-untyped-def]
    """The angle at which all loads balance, and its tangent.

    Newton's method from `at`, held between bounds; a step ends it that is so short that the
    equation's bend, told from the slope before at `start`, moves the angle by less than PRECISE
    of a radian; where the joint is about to snap over, or at the kinks of a pad, the slope tells
    nothing.
    """
    contact, pads, precise = bends[4], bends[11].shape[0], PRECISE / bends[3]
    low, high, under, over = -NEVER, NEVER, -1.0, 1.0
    slope, yielding = tangent[0], tangent[1]
    wires, taut = 0.0, 1.0
    for sweep in range(SWEEPS):
        last = slope
        rest, slope, taut, wires = _missing(at, start, asked, stiff, pull, bends)
        if slope != last:
            yielding = 1.0 / slope
        move = rest * yielding
        if abs(move) < precise:
            break
        if rest > 0.0:
            high, over = at, rest
        else:
            low, under = at, rest
        at -= move
        if at <= low or at >= high or (sweep > PATIENCE and sweep % 2 and high - low < NEVER):
            share = 0.5 if sweep % 2 else under / (under - over)
            at = low + share * (high - low)
        elif pads > 0 or (contact.shape[0] > 0 and abs(move * contact[0, 0]) > 1.0):
            continue
        elif (
            slope > LEAST_SLOPE
            and SAFE * move * move * abs(slope - last) < precise * abs(at + move - start) * slope
        ):
            break
    return at, (slope, yielding, taut * yielding, (1.0 + taut * wires) * yielding)


@inlined
def _settled(at, start, asked, stiff, pull, tangent, bends):  # type: ignore[no-untyped-def]
    """The same: on a line, which needs no angle to begin at, where nothing touches the joint."""
    low, high = bends[10]
    if low < high:
        slope = 1.0 + stiff + softness(bends)
        yielding = tangent[1] if slope == tangent[0] else 1.0 / slope
        there = (asked + pull) * yielding
        if low < there < high:
            return there, (slope, yielding, yielding, yielding)
    return _rested(at, start, asked, stiff, pull, tangent, bends)


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
def _moved(at, joint, asked, stiff, pull, bends, slip, ends):  # type: ignore[no-untyped-def]
    """A joint (angle, tangent, bank of sliders) that balances anew: it turns, or sliders slide."""
    theta, tangent, bank = joint
    turned = False
    while True:
        way, stuck, held, near = bank
        if bends is None:
            slope = 1.0 + stiff + stuck
            if slope != tangent[0]:
                tangent = (slope, 1.0 / slope, 1.0 / slope, 1.0 / slope)
            at = (asked + pull - held) * tangent[1]
        else:
            if slip.shape[0] > 0 and slip[0, 3] != 0.0:
                wider = 1.0 + slip[0, 3] * abs(theta)
                stuck, held = wider * stuck, wider * held
            at, tangent = _settled(at, theta, asked, stiff + stuck, pull - held, tangent, bends)
        if slip.shape[0] == 0:
            break
        if way * (at - near) > 0.0:
            bank = _line(way, near, ends, slip)
        elif way * (at - theta) < 0.0 and not turned:
            turned = True
            _turn(way, theta, ends, slip)
            bank = _line(-way, theta, ends, slip)
        else:
            break
    return at, tangent, bank


@inlined
def _without_bristles(bends):  # type: ignore[no-untyped-def]
    """What bends a joint at the very beginning: bristles stand upright."""
    if bends is None:
        return bends
    return (*bends[:8], bends[8][:0], *bends[9:])


@inlined
def _bend(start, at, bends):  # type: ignore[no-untyped-def]
    """Forces of the bristles and of the pads (in place) after a step of the joint."""
    if bends is not None:
        bristle, bent = bends[8], bends[9]
        for j in range(bristle.shape[0]):
            stiffness, up, down, free = bristle[j, 0], bristle[j, 1], bristle[j, 2], bristle[j, 3]
            bent[j] = bristled(bent[j], at - start, stiffness, up, down, free)[0]
        pad, pressed = bends[11], bends[12]
        for j in range(pad.shape[0]):
            pressed[j] = abs(_padded(pressed[j], start, at, pad[j])[0])


@inlined
def _held(firm, wait, drag, hold):  # type: ignore[no-untyped-def]
    """How a dashpot holds a joint of that stiffness over a wait: as `hold`, anew.

    hold: stiffness, wait, stiffness of the spring that the dashpot is, a power, the spring's force.
    """
    if firm == hold[0] and abs(wait - hold[1]) <= SAME_DWELL * hold[1]:
        return hold
    grown, known = power(min(firm * wait / drag, LONG), hold[3])
    return firm, wait, firm / max(grown - 1.0, BRIEF), known, hold[4]


@inlined
def _stiffness(tangent, bends):  # type: ignore[no-untyped-def]
    """What a load must grow by to move the joint by one, its dashpot's spring included."""
    if bends is None:
        return tangent[0]
    return 1.0 / tangent[3]


@inlined
def _taut(at, asked, bends):  # type: ignore[no-untyped-def]
    """Which of two loose wires pulls a joint at an angle: 1, -1, or 0 for neither of them."""
    side = 0.0
    if bends is not None:
        half, _, own, _, centre, _, _ = bends[6]
        stretch = own * (at - centre) + asked - at
        if half > 0.0 and abs(stretch) > half:
            side = 1.0 if stretch > 0.0 else -1.0
    return side


@inlined
def _dwelt(at, joint, asked, free, load, dwell, drag, firm, hold, bends, slip, ends):  # type: ignore[no-untyped-def]
    """A joint after a dwell with a dashpot, its own stiffness, how it is held, and its pull.

    In one go, or, where its stiffness changes by more than EVEN on the way, or it comes to hang on
    another wire, in parts.
    """
    taut = _taut(joint[0], asked, bends)
    before, began, wait, left, whole = joint, firm, dwell, dwell, True
    at += hold[4] * joint[1][3]
    while True:
        start = joint[0]
        hold = _held(firm, wait, drag, hold)
        pull = load + hold[2] * start
        joint = _moved(at, joint, asked, free + hold[2], pull, bends, slip, ends)
        firm = max(_stiffness(joint[1], bends) - hold[2], SOFTEST)
        even = EVEN * began < firm < began / EVEN and taut == _taut(joint[0], asked, bends)
        if whole and not even:
            if joint[2][0] != before[2][0]:
                _turn(joint[2][0], start, ends, slip)
            at, joint, firm = start, before, began
            whole, wait = False, FIRST_PART * dwell
            continue
        _bend(start, joint[0], bends)
        hold = hold[0], hold[1], hold[2], hold[3], hold[2] * (joint[0] - start)
        left -= wait
        if left <= 0.0:
            return joint, firm, hold, pull
        at, wait = joint[0] + hold[4] * joint[1][3], min(GROWTH * wait, left)


@njit(cache=True, fastmath=True, error_model="numpy", _nrt=False)  # type: ignore[call-overload]
def balance(q, pushed, dwell, loads, state, out):  # type: ignore[no-untyped-def]
    """Joint angles `out` for the asked angles `q`, (n,) each, and the state to carry (in place).

    state: q + pushed, angle, forces of the sliders, of the bristles and of the pads, far ends of
    the arms, stretches of the wires and their pull (where there are such), stiffness r; all 0
    before the first sample, but those of pads NEVER. A sample is taken after its dwell: first the
    joint moves at once, then the arms relax, the wires get longer, and it settles again; wires of
    a drive that runs from sample to sample get longer on the way. Where the stiffness r changes on
    the way, by more than EVEN, a joint with drag goes it again in parts of the dwell, each with its
    own r. loads: see `balance.Loads`. A tangent is the equation's slope, one over it, and how far
    the joint moves for what is asked and for a load.
    """
    slip, arm, drag, softest, bends, wire = loads
    arms, hold = arm.shape[0], (-1.0, -1.0, 0.0, (NEVER, 0.0), 0.0)
    last = state.size - 1 - slots(wire)
    ends, far = state[2 : 2 + slip.shape[0]], state[last - arms : last]
    stretched, waits = state[last:-1], arms > 0 or held_through(wire)
    asked, joint, firm = state[0], (state[1], STRAIGHT, (1.0, 0.0, 0.0, NEVER)), state[-1]
    if firm == 0.0:
        asked, firm = q[0] + pushed[0], 1.0
        joint, alone = (asked, STRAIGHT, joint[2]), _without_bristles(bends)
        yields = lengthening(q[0], stretched, NEVER, 1.0, wire)
        stiff, bent = softened(softest, yields[0], alone, wire)
        joint = _moved(asked, joint, q[0] - yields[1], stiff, pushed[0], bent, slip[:0], ends)
        lengthen(joint[0], q[0], yields, stretched, wire)
        begin(stretched, wire)
        far[:] = joint[0]
    _ends(1.0, joint[0], ends, slip)
    joint = (joint[0], joint[1], _line(1.0, joint[0], ends, slip))
    eased, relaxed, arm[:, 3] = -1.0, -1.0, NEVER
    for t in range(q.size):
        stiff, pull = pulled(softest, pushed[t], far, arm)
        at, last = joint[0] + (q[t] + pushed[t] - asked) * joint[1][2], joint[0]
        asked, late = q[t] + pushed[t], 0.0
        yields = longer_by(stretched, wire)
        if not waits:
            yields = lengthening(q[t], stretched, dwell[t], 1.0, wire)
        free = q[t] - yields[1]
        firmer, softer = softened(stiff, yields[0], bends, wire)
        if drag > 0.0:
            joint, firm, hold, pull = _dwelt(
                at, joint, free, firmer, pull, dwell[t], drag, firm, hold, softer, slip, ends
            )
            stiff += hold[2]
        else:
            joint = _moved(at, joint, free, firmer, pull, softer, slip, ends)
            _bend(last, joint[0], bends)
        if waits:
            if eased != joint[1][3] or abs(dwell[t] - relaxed) > SAME_DWELL * relaxed:
                eased, relaxed = joint[1][3], dwell[t]
                let_go(eased, relaxed, arm)
            late, last = relax(joint[0], far, arm), joint[0]
            yields = lengthening(q[t], stretched, dwell[t], joint[1][2], wire)
            free = q[t] - yields[1]
            firmer, softer = softened(stiff, yields[0], bends, wire)
            at = last + late * eased
            joint = _moved(at, joint, free, firmer, pull + late, softer, slip, ends)
            _bend(last, joint[0], bends)
            firm = max(_stiffness(joint[1], bends) - hold[2], SOFTEST)
        lengthen(joint[0], q[t], yields, stretched, wire)
        out[t] = joint[0]
    _forces(joint[2][0], joint[0], ends, slip)
    state[0], state[1], state[-1] = asked, joint[0], firm

"""Wires that go on stretching under their pull (Kelvin and Voigt): `Load.wire` in `balance.py`."""

from typing import Any

import numpy as np
from numba.core.types import NoneType
from numba.extending import overload

from pipeline.physics.tabled import inlined

BRIEF = 1e-9  # dwells over a time constant
PARTS = 13  # of all that bends a balance, but for the softness of wires


@inlined
def _grown(wire, dwell, eases):  # type: ignore[no-untyped-def]
    """How far a wire stretches over a dwell, of the way to where its pull would have it.

    And the share in that pull of the one at the end, the other being that at the beginning: where
    the drive runs the pull changes evenly between them. Where it is held, the pull at the end has
    all, and it is exact where that changes with the stretch, of which the joint follows `eases`.
    """
    wait = dwell / wire[1]
    if wire[3] > 0.0:
        gone = 1.0 - np.exp(-wait)
        return gone, 1.0 / gone - 1.0 / wait if wait > BRIEF else 0.5
    more = wire[0] * (eases + (1.0 - eases) / wire[2])
    left = np.exp(-(1.0 + more) * wait)
    return (1.0 - left) / (1.0 + left * more), 1.0


@inlined
def slots(wire):  # type: ignore[no-untyped-def]
    """How many numbers of the state are those of wires: their stretches and their pull."""
    if wire is None:
        return 0
    return wire.shape[0] + 1


@inlined
def held_through(wire):  # type: ignore[no-untyped-def]
    """Whether the drive of such wires is held through each dwell."""
    if wire is None:
        return False
    return wire[0, 3] == 0.0


@inlined
def longer_by(stretched, wire):  # type: ignore[no-untyped-def]
    """How long all wires are by now, whatever the angle: as `lengthening`."""
    longer = 0.0
    if wire is not None:
        for j in range(wire.shape[0]):
            longer += stretched[j]
    return 0.0, longer


@inlined
def lengthening(asked, stretched, dwell, eases, wire):  # type: ignore[no-untyped-def]
    """Stiffness and stretch at 0 of wires that go on stretching over a dwell, for one angle then.

    Their stretches go to share * pull, the pull being own * theta + f in `balance.py`, over own.
    stretched: all of them, and the pull at the beginning. wire: (w, 7) the first five columns of
    `Load.wire`, and two to keep what `_grown` says until they are longer.
    """
    if wire is None:
        return 0.0, 0.0
    share, kept, before = 0.0, 0.0, stretched[-1]
    for j in range(wire.shape[0]):
        grown, late = _grown(wire[j], dwell, eases)
        wire[j, 5], wire[j, 6] = grown, late
        share += grown * late * wire[j, 0]
        kept += stretched[j] + grown * ((1.0 - late) * wire[j, 0] * before - stretched[j])
    own = wire[0, 2]
    return share * (own - 1.0) / (own + share), (own * kept + share * asked) / (own + share)


@inlined
def lengthen(theta, asked, yields, stretched, wire):  # type: ignore[no-untyped-def]
    """Their stretches and pull (in place) at the angle in which that ends."""
    if wire is not None:
        load, before = asked - theta * (1.0 + yields[0]) - yields[1], stretched[-1]
        pull = theta + load / wire[0, 2]
        for j in range(wire.shape[0]):
            mean = wire[j, 6] * pull + (1.0 - wire[j, 6]) * before
            stretched[j] += wire[j, 5] * (wire[j, 0] * mean - stretched[j])
        stretched[-1] = pull


@inlined
def begin(stretched, wire):  # type: ignore[no-untyped-def]
    """Wires (in place) that were longer before the first sample than their pull has them there."""
    if wire is not None:
        for j in range(wire.shape[0]):
            stretched[j] += wire[j, 4]


def softened(stiff, soft, bends, wire):  # type: ignore[no-untyped-def]
    """Stiffness, and what bends, where wires stretch by `soft` times the angle besides."""
    if wire is None:
        return stiff, bends
    return (stiff + soft, bends) if bends is None else (stiff, (*bends, soft))


@overload(softened)
def _softened(stiff, soft, bends, wire):  # type: ignore[no-untyped-def]
    if isinstance(wire, NoneType):
        return lambda stiff, soft, bends, wire: (stiff, bends)
    if isinstance(bends, NoneType):
        return lambda stiff, soft, bends, wire: (stiff + soft, bends)
    return lambda stiff, soft, bends, wire: (stiff, (*bends, soft))


def softness(bends: tuple[Any, ...]) -> float:
    """By how much wires stretch for an angle [1], where something bends; compiled away where none.

    See `softened`, which puts it behind all else that bends.
    """
    return float(bends[PARTS]) if len(bends) > PARTS else 0.0


@overload(softness)
def _softness(bends):  # type: ignore[no-untyped-def]
    if len(bends) > PARTS:
        return lambda bends: bends[PARTS]
    return lambda bends: 0.0

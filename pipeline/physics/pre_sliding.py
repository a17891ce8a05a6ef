"""Pre-sliding: how a dry contact turns from one direction of sliding to the other."""

from functools import cache

import numpy as np
from numba import njit

from pipeline.physics.decay import decayed

ELEMENTS, FINELY = 8, 32
WIDEST, FASTEST = 2.5, 3.0  # of a spread, of a release


@cache
def _quantiles(elements: int) -> np.ndarray:
    """Of an exponential distribution with mean 1, (elements,)."""
    found = -np.log(1.0 - (np.arange(elements) + 0.5) / elements)
    return np.asarray(found / found.mean())


def reaches_of(reach: float, spread: float, elements: int = ELEMENTS) -> np.ndarray:
    """Reaches of the slip elements, (elements,), with the mean `reach`."""
    quantiles = _quantiles(elements)
    if spread <= 1.0:
        return np.asarray(reach * (1.0 - spread + spread * quantiles))
    powers = quantiles**spread
    return np.asarray(reach * powers / powers.mean())


def evenly(reach: float, spread: float) -> np.ndarray:
    """As `reaches_of`, (FINELY,), from reach * (1 - spread) to reach * (1 + spread) in equal steps.

    Source: Iwan, J. Appl. Mech. 33 (1966) 893, whose sliders are as many of each strength.
    """
    return reach * (1.0 + spread * ((2.0 * np.arange(FINELY) + 1.0) / FINELY - 1.0))


@njit(cache=True, fastmath={"contract", "reassoc", "nsz", "nnan"}, error_model="numpy")
def _slipped(position, at, reaches, state):  # type: ignore[no-untyped-def]
    out, per_way = np.empty(position.size), 1.0 / reaches
    for i in range(position.size):
        moved = position[i] - at
        at = position[i]
        total = 0.0
        for j in range(reaches.size):
            share = min(1.0, max(-1.0, state[j] + moved * per_way[j]))
            state[j] = share
            total += share
        out[i] = total / reaches.size
    return out


def sliding(
    position: np.ndarray,
    reach: float,
    spread: float,
    state: np.ndarray | None,
    elements: int = ELEMENTS,
) -> tuple[np.ndarray, np.ndarray]:
    """Share of the sliding friction that acts, (n,) from -1 to 1, and the state to carry.

    A bank of springs with dry sliders in series: element i sticks over reach * (1 - spread +
    spread e_i) of travel [position's unit], e_i being the quantiles of an exponential distribution
    with mean 1. spread = 0 is one elasto-plastic slider, 1 comes close to Dahl's curve. It begins
    unstressed. Source: Iwan, J. Appl. Mech. 33 (1966) 893; Al-Bender, Lampaert and Swevers, IEEE
    Trans. Autom. Control 50 (2005) 1883 (generalized Maxwell-slip).
    """
    return slipped(position, reaches_of(reach, spread, elements), state)


def slipped(
    position: np.ndarray, reaches: np.ndarray, state: np.ndarray | None
) -> tuple[np.ndarray, np.ndarray]:
    """As `sliding`, of elements of any reaches, (elements,) [position's unit], all as strong."""
    carried = np.zeros(len(reaches)) if state is None else state[1:].copy()
    at = float(position[0]) if state is None else float(state[0])
    out = _slipped(np.ascontiguousarray(position), at, reaches, carried)
    return out, np.concatenate([position[-1:], carried])


@njit(cache=True, error_model="numpy")
def bristled(force, step, stiffness, up, down, release):  # type: ignore[no-untyped-def]
    """The force of a bristle after a step of the contact, and its slope by that step.

    f' = stiffness (1 - f / limit) in the direction of the step, limit being `up` or `down`; while f
    still helps the step, stiffness (1 + release |f| / limit). release = 1 is Dahl's bristle, 0 that
    of Bouc and Wen with equal shares, which lets go as a spring; of theirs with any, release =
    (beta - gamma) / (beta + gamma), which is never negative (Erlicher and Point, C. R. Mecanique
    332 (2004) 51). Exact for any step. Source: Dahl, AIAA J. 14 (1976) 1675; Wen, J. Eng. Mech. 102
    (1976) 249 (n = 1).
    """
    side, limit = (1.0, up) if step >= 0.0 else (-1.0, down)
    if limit <= 0.0:
        return 0.0, 0.0
    share, way = side * force / limit, stiffness * abs(step) / limit
    if share < 0.0:
        free = np.log(1.0 - release * share) / release if release > 1e-6 else -share
        if way < free:
            if release > 1e-6:
                share = (1.0 - (1.0 - release * share) * decayed(release * way)) / release
            else:
                share += way
            return side * limit * share, stiffness * (1.0 - release * share)
        share, way = 0.0, way - free
    left = (1.0 - share) * decayed(way)
    return side * limit * (1.0 - left), stiffness * left


@njit(cache=True)
def _dragged(position, at, reach, release, force):  # type: ignore[no-untyped-def]
    out = np.empty(position.size)
    for i in range(position.size):
        force = bristled(force, position[i] - at, 1.0 / reach, 1.0, 1.0, release)[0]
        at = position[i]
        out[i] = force
    return out


def dragging(
    position: np.ndarray, reach: float, release: float, state: np.ndarray | None
) -> tuple[np.ndarray, np.ndarray]:
    """As `sliding`, of one bristle that gives way over `reach` (see `bristled`)."""
    at, force = (float(position[0]), 0.0) if state is None else (float(state[0]), float(state[1]))
    out = _dragged(np.ascontiguousarray(position), at, reach, release, force)
    return out, np.array([position[-1], out[-1]])


@njit(cache=True)
def _lagged(position, more, reach, at, dry, lag):  # type: ignore[no-untyped-def]
    out = np.empty(position.size)
    for i in range(position.size):
        moved = position[i] - at
        at = position[i]
        dry = bristled(dry, moved, 1.0 / reach, 1.0, 1.0, 1.0)[0]
        lag = dry * more[i] + (lag - dry * more[i]) * decayed(abs(moved) / reach)
        out[i] = lag
    return out, dry


def lagging(
    position: np.ndarray, more: np.ndarray, reach: float, state: np.ndarray | None
) -> tuple[np.ndarray, np.ndarray]:
    """How much of what a contact can hold beyond its dry friction acts, (n,) from -1 to 1.

    more: the share of it that slow sliding has, (n,), by the speed. A contact learns of its speed
    as its bristles do, over the travel `reach`: f' = (x' - |x'| f / (1 + e more)) / reach, to first
    order in e, is f = z + e y with Dahl's z and y' = |x'| (more z - y) / reach. And the state to
    carry. Source: the LuGre model, Canudas de Wit, Olsson, Astrom and Lischinsky, IEEE Trans.
    Autom. Control 40 (1995) 419.
    """
    at, dry, lag = (position[0], 0.0, 0.0) if state is None else state
    out, dry = _lagged(
        np.ascontiguousarray(position), more, reach, float(at), float(dry), float(lag)
    )
    return out, np.array([position[-1], dry, out[-1]])


def weighted(share: np.ndarray, asymmetry: float) -> np.ndarray:
    """A share (n,) that is 1 + asymmetry times as large where it is positive, 1 - where not."""
    return share if asymmetry == 0.0 else share * (1.0 + asymmetry * np.sign(share))

"""The balance at the joint: friction, stretch, gravity, contact and stop meet in one equation.

q = theta + sum_i f_i[theta] + stretch(theta) + gravity(theta) + contact(theta) + stop(theta)

q is the angle that the wire asks for, theta the angle that the joint takes; every load is divided
by the stiffness of the wire, so that it is the angle [angle unit] by which the wire gives way.
The slip elements f_i are springs with dry sliders in series (Iwan, J. Appl. Mech. 33 (1966) 893).
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol, cast

import numpy as np
from numba import njit

if TYPE_CHECKING:
    from pipeline.physics.mechanism import Piece

NO_SLIP = np.zeros((0, 4))
NO_CONTACT = np.zeros((0, 4))
SWEEPS = 40


@dataclass(frozen=True)
class Load:
    """What a term adds to the balance.

    slip: (m, 4) stiffness, force limit against rising, force limit against falling, and growth of
        the limits with the joint's angle [1/angle unit].
    smooth: (4,) linear [1], cubic [1/angle^2], gravity [angle] and gravity's zero [rad].
    contact: (c, 4) side (+1, -1), angle, stiffness [1], rounding [angle].
    """

    slip: np.ndarray = field(default_factory=lambda: NO_SLIP)
    smooth: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    contact: np.ndarray = field(default_factory=lambda: NO_CONTACT)


class BalancedTerm(Protocol):
    """A term that has a load."""

    def load(self, values: np.ndarray) -> Load: ...


@njit(cache=True)
def _smooth(theta, linear, cubic, gravity, zero, radian, contact):  # type: ignore[no-untyped-def]
    """Load of everything without memory and its slope."""
    load = linear * theta + cubic * theta * theta * theta
    slope = linear + 3.0 * cubic * theta * theta
    if gravity != 0.0:
        load += gravity * (np.sin(theta / radian - zero) + np.sin(zero))
        slope += gravity / radian * np.cos(theta / radian - zero)
    for j in range(contact.shape[0]):
        depth = contact[j, 0] * (theta - contact[j, 1])
        rounding = contact[j, 3]
        if depth >= rounding:
            load += contact[j, 0] * contact[j, 2] * depth
            slope += contact[j, 2]
        elif depth > -rounding:
            bite = depth + rounding
            load += contact[j, 0] * contact[j, 2] * bite * bite / (4.0 * rounding)
            slope += contact[j, 2] * bite / (2.0 * rounding)
    return load, slope


@njit(cache=True)
def _solve(q, theta, force, slip, smooth, radian, contact):  # type: ignore[no-untyped-def]
    """theta with q = theta + loads, from the state (theta, force); `force` is brought up to date."""
    m = slip.shape[0]
    at = theta
    low, high = -1e300, 1e300
    for _ in range(SWEEPS):
        load, slope = _smooth(at, smooth[0], smooth[1], smooth[2], smooth[3], radian, contact)
        rest = at + load - q
        stiffness = 1.0 + slope
        step = at - theta
        for i in range(m):
            f = force[i] + slip[i, 0] * step
            grown = 1.0 + slip[i, 3] * abs(at)
            if f > slip[i, 1] * grown:
                f = slip[i, 1] * grown
            elif f < -slip[i, 2] * grown:
                f = -slip[i, 2] * grown
            else:
                stiffness += slip[i, 0]
            rest += f
        if rest > 0.0:
            high = at
        else:
            low = at
        if stiffness < 0.05:
            stiffness = 0.05
        move = rest / stiffness
        if abs(move) < 1e-9:
            break
        at -= move
        if at <= low or at >= high:
            at = 0.5 * (low + high)
    step = at - theta
    for i in range(m):
        f = force[i] + slip[i, 0] * step
        grown = 1.0 + slip[i, 3] * abs(at)
        force[i] = min(max(f, -slip[i, 2] * grown), slip[i, 1] * grown)
    return at


@njit(cache=True)
def balance(q, state, slip, smooth, radian, contact, fresh):  # type: ignore[no-untyped-def]
    """Joint angles for the asked angles `q`, shape (n,), and the state (theta, forces)."""
    out = np.empty(q.size)
    force = state[1:].copy()
    theta = state[0]
    if fresh and q.size > 0:
        theta = _solve(q[0], q[0], force, slip[:0], smooth, radian, contact)
    for i in range(q.size):
        theta = _solve(q[i], theta, force, slip, smooth, radian, contact)
        out[i] = theta
    after = np.empty(state.size)
    after[0] = theta
    after[1:] = force
    return out, after


def settle(
    asked: np.ndarray, pieces: Sequence["Piece"], state: np.ndarray | None, radian: float
) -> tuple[np.ndarray, np.ndarray]:
    """Joint angles, shape (n,), and the state to carry; unstressed at the first sample."""
    loads = [cast(BalancedTerm, p.term).load(p.values) for p in pieces]
    slip = np.concatenate([load.slip for load in loads])
    contact = np.concatenate([load.contact for load in loads])
    smooth = np.sum([load.smooth for load in loads], axis=0)
    fresh = state is None
    carried = np.zeros(1 + len(slip)) if state is None else state
    return balance(np.ascontiguousarray(asked), carried, slip, smooth, radian, contact, fresh)

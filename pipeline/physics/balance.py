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

NO_SLIP = np.zeros((0, 3))
NO_CONTACT = np.zeros((0, 4))
SWEEPS = 40


@dataclass(frozen=True)
class Load:
    """What a term adds to the balance.

    slip: (m, 3) stiffness [1], force limit against rising and against falling [angle unit].
    smooth: (6,) linear [1], cubic [1/angle^2], gravity [angle], gravity's zero [rad], toe [angle]
        and the reach of the toe [angle].
    contact: (c, 4) side (+1, -1), angle, stiffness [1], rounding [angle].
    """

    slip: np.ndarray = field(default_factory=lambda: NO_SLIP)
    smooth: tuple[float, ...] = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    contact: np.ndarray = field(default_factory=lambda: NO_CONTACT)


class BalancedTerm(Protocol):
    """A term that has a load."""

    def load(self, values: np.ndarray) -> Load: ...


@njit(cache=True, fastmath=True, error_model="numpy")
def _stops(at, radian, gravity, zero, contact):  # type: ignore[no-untyped-def]
    """Load of gravity, contacts and stops at an angle, and its slope."""
    load = gravity * (np.sin(at / radian - zero) + np.sin(zero))
    slope = gravity / radian * np.cos(at / radian - zero)
    for j in range(contact.shape[0]):
        depth = contact[j, 0] * (at - contact[j, 1])
        rounding = contact[j, 3]
        if depth >= rounding:
            load += contact[j, 0] * contact[j, 2] * depth
            slope += contact[j, 2]
        elif depth > -rounding:
            bite = depth + rounding
            load += contact[j, 0] * contact[j, 2] * bite * bite / (4.0 * rounding)
            slope += contact[j, 2] * bite / (2.0 * rounding)
    return load, slope


@njit(cache=True, fastmath=True, error_model="numpy")
def balance(q, state, slip, smooth, radian, contact, fresh):  # type: ignore[no-untyped-def]
    """Joint angles for the asked angles `q`, shape (n,), and the state (q, angle, forces)."""
    linear, cubic, gravity, zero = smooth[0], smooth[1], smooth[2], smooth[3]
    toe, reach = smooth[4], max(smooth[5], 1e-9)
    plain = contact.shape[0] == 0 and gravity == 0.0
    m = slip.shape[0]
    stiffness, above, below = slip[:, 0].copy(), slip[:, 1].copy(), -slip[:, 2]
    force, trial = state[2:].copy(), np.empty(m)
    out = np.empty(q.size)
    asked, theta, give = state[0], state[1], 1.0
    for t in range(q.size):
        sliding = 0 if fresh and t == 0 else m
        at = q[0] if sliding < m else theta + (q[t] - asked) * give
        asked = q[t]
        low, high = -1e300, 1e300
        for _ in range(SWEEPS):
            rest = at + linear * at + cubic * at * at * at - asked
            slope = 1.0 + linear + 3.0 * cubic * at * at
            if toe != 0.0:
                bent = np.tanh(at / reach)
                rest += toe * bent
                slope += toe / reach * (1.0 - bent * bent)
            if not plain:
                more, steeper = _stops(at, radian, gravity, zero, contact)
                rest += more
                slope += steeper
            step = at - theta
            for i in range(sliding):
                free = force[i] + stiffness[i] * step
                held = min(max(free, below[i]), above[i])
                trial[i] = held
                rest += held
                slope += stiffness[i] if free == held else 0.0
            give = 1.0 / max(slope, 0.05)
            move = rest * give
            if abs(move) < 1e-9:
                break
            if rest > 0.0:
                high = min(high, at)
            else:
                low = max(low, at)
            at -= move
            if at <= low or at >= high:
                at = 0.5 * (low + high)
        theta = at
        for i in range(sliding):
            force[i] = trial[i]
        out[t] = at
    after = np.empty(2 + m)
    after[0], after[1] = asked, theta
    after[2:] = force
    return out, after


def settle(
    asked: np.ndarray, pieces: Sequence["Piece"], state: np.ndarray | None, radian: float
) -> tuple[np.ndarray, np.ndarray]:
    """Joint angles, shape (n,), and the state to carry; unstressed at the first sample."""
    loads = [cast(BalancedTerm, p.term).load(p.values) for p in pieces]
    slip = np.concatenate([load.slip for load in loads])
    contact = np.concatenate([load.contact for load in loads])
    smooth = np.sum([load.smooth for load in loads], axis=0)  # a reach stands in one load only
    fresh = state is None
    carried = np.zeros(2 + len(slip)) if state is None else state
    return balance(np.ascontiguousarray(asked), carried, slip, smooth, radian, contact, fresh)

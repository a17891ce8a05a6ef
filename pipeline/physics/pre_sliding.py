"""Pre-sliding: how a dry contact turns from one direction of sliding to the other."""

import numpy as np
from numba import njit

ELEMENTS = 8
QUANTILES = -np.log(1.0 - (np.arange(ELEMENTS) + 0.5) / ELEMENTS)
QUANTILES /= QUANTILES.mean()


@njit(cache=True)
def _slipped(position, at, reaches, state):  # type: ignore[no-untyped-def]
    out = np.empty(position.size)
    for i in range(position.size):
        moved = position[i] - at
        at = position[i]
        total = 0.0
        for j in range(reaches.size):
            state[j] = min(1.0, max(-1.0, state[j] + moved / reaches[j]))
            total += state[j]
        out[i] = total / reaches.size
    return out


def sliding(
    position: np.ndarray, reach: float, spread: float, state: np.ndarray | None
) -> tuple[np.ndarray, np.ndarray]:
    """Share of the sliding friction that acts, (n,) from -1 to 1, and the state to carry.

    A bank of springs with dry sliders in series: element i sticks over reach * (1 - spread +
    spread e_i) of travel [position's unit], e_i being the quantiles of an exponential distribution
    with mean 1. spread = 0 is one elasto-plastic slider, 1 comes close to Dahl's curve. It begins
    unstressed. Source: Iwan, J. Appl. Mech. 33 (1966) 893; Al-Bender, Lampaert and Swevers, IEEE
    Trans. Autom. Control 50 (2005) 1883 (generalized Maxwell-slip).
    """
    reaches = reach * (1.0 - spread + spread * QUANTILES)
    carried = np.zeros(ELEMENTS) if state is None else state[1:].copy()
    at = float(position[0]) if state is None else float(state[0])
    out = _slipped(np.ascontiguousarray(position), at, reaches, carried)
    return out, np.concatenate([position[-1:], carried])


def weighted(share: np.ndarray, asymmetry: float) -> np.ndarray:
    """A share (n,) that is 1 + asymmetry times as large where it is positive, 1 - where not."""
    return share * (1.0 + asymmetry * np.sign(share))

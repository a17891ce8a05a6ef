"""A bristle that gives way sooner or later than Dahl's: Bouc and Wen's exponent, or Dahl's own."""

import numpy as np
from numba import njit

LONGEST, LEAST_LEFT = 0.2, 1e-7


@njit(cache=True, error_model="numpy")
def _left(from_, way, bend):  # type: ignore[no-untyped-def]
    """What u' = -u^bend comes to after a way, bend > 1."""
    return (from_ ** (1.0 - bend) + (bend - 1.0) * way) ** (1.0 / (1.0 - bend))


@njit(cache=True, error_model="numpy")
def _softly(share, way, bend, release):  # type: ignore[no-untyped-def]
    if share < 0.0:
        begun = 1.0 - release * share
        end = _left(begun, release * way, bend) if release > 1e-6 else begun
        gone = (begun - end) / release if release > 1e-6 else way
        if gone < -share:
            return share + gone
        needed = -share
        if release > 1e-6:
            needed = (1.0 - begun ** (1.0 - bend)) / ((bend - 1.0) * release)
        way, share = way - needed, 0.0
    left = 1.0 - share
    return 1.0 - _left(left, way, bend) if left > LEAST_LEFT else 1.0


@njit(cache=True, error_model="numpy")
def _rate(share, power, release):  # type: ignore[no-untyped-def]
    if share < 0.0:
        return 1.0 + release * (-share) ** power
    return 1.0 - min(share, 1.0) ** power


@njit(cache=True, error_model="numpy")
def _sharply(share, way, power, release):  # type: ignore[no-untyped-def]
    while way > 0.0 and 1.0 - share > LEAST_LEFT:
        step = min(way, LONGEST)
        way -= step
        a = _rate(share, power, release)
        b = _rate(share + 0.5 * step * a, power, release)
        c = _rate(share + 0.5 * step * b, power, release)
        d = _rate(share + step * c, power, release)
        share = min(share + step / 6.0 * (a + 2.0 * b + 2.0 * c + d), 1.0)
    return share


@njit(cache=True, error_model="numpy")
def _bent(position, at, reach, release, curve, share):  # type: ignore[no-untyped-def]
    out = np.empty(position.size)
    for i in range(position.size):
        moved = position[i] - at
        at = position[i]
        side = 1.0 if moved >= 0.0 else -1.0
        way = side * moved / reach
        if curve < 1.0:
            share = side * _softly(side * share, way, 1.0 / curve, release)
        else:
            share = side * _sharply(side * share, way, curve, release)
        out[i] = share
    return out


def bending(
    position: np.ndarray, reach: float, release: float, curve: float, state: np.ndarray | None
) -> tuple[np.ndarray, np.ndarray]:
    """As `pre_sliding.dragging`, of a bristle whose way to sliding is bent otherwise.

    While f goes to 1 it is f' = (1 - f^curve) / reach for curve > 1 (Bouc and Wen's exponent), the
    sharper the larger; f' = (1 - f)^(1 / curve) / reach for curve < 1 (Dahl's exponent), the softer
    the smaller. While f still helps the step, there is release |f| in the place of -f. Source: Wen,
    J. Eng. Mech. 102 (1976) 249; Dahl, AIAA J. 14 (1976) 1675.
    """
    at, share = (float(position[0]), 0.0) if state is None else (float(state[0]), float(state[1]))
    out = _bent(np.ascontiguousarray(position), at, reach, release, float(curve), share)
    return out, np.array([position[-1], out[-1]])

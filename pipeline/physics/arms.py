"""Arms in the balance: springs with dashpots in series, which let go over a dwell (Maxwell).

arm: (a, 5) stiffness, time constant, share of the stretch that is let go, and a power known.
"""

import numpy as np

from pipeline.physics.tabled import inlined

NEARBY = 0.01


@inlined
def pulled(stiff, pull, far, arm):  # type: ignore[no-untyped-def]
    """Stiffness and pull with those of the arms."""
    for j in range(arm.shape[0]):
        stiff += arm[j, 0]
        pull += arm[j, 0] * far[j]
    return stiff, pull


@inlined
def power(x, known):  # type: ignore[no-untyped-def]
    """exp(x), with known = (y, exp(y)) of a y nearby; and that. Dwells differ little: a series."""
    more = x - known[0]
    if abs(more) > NEARBY:
        known, more = (x, np.exp(x)), 0.0
    series = 1.0 + more * (1.0 + more / 2.0 * (1.0 + more / 3.0 * (1.0 + more / 4.0)))
    return known[1] * series, known


@inlined
def let_go(eases, dwell, arm):  # type: ignore[no-untyped-def]
    """Share of its stretch that each arm loses over a dwell, and what tells it (in place)."""
    for j in range(arm.shape[0]):
        pace = max(1.0 - arm[j, 0] * eases, 1e-3)
        left, known = power(-pace * dwell / arm[j, 1], (arm[j, 3], arm[j, 4]))
        arm[j, 2], arm[j, 3], arm[j, 4] = (1.0 - left) / pace, known[0], known[1]


@inlined
def relax(theta, far, arm):  # type: ignore[no-untyped-def]
    """Load that the arms let go; their far ends move (in place)."""
    late = 0.0
    for j in range(arm.shape[0]):
        moved = (theta - far[j]) * arm[j, 2]
        late += arm[j, 0] * moved
        far[j] += moved
    return late

"""A bank of springs with dry sliders: one spring, while a joint goes one way, up to the next slip.

Iwan, J. Appl. Mech. 33 (1966) 893. Rows of `slip`: stiffness, force limits against rising and
against falling; `ends`: the angles at which they slide.
"""

from pipeline.physics.tabled import inlined

NEVER = 1e300


@inlined
def line_of(way, at, ends, slip):  # type: ignore[no-untyped-def]
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
def turn(way, at, ends, slip):  # type: ignore[no-untyped-def]
    """Where each slider will slide (in place) when a joint that came this way to `at` turns."""
    for i in range(slip.shape[0]):
        reached = max(ends[i], at) if way > 0.0 else min(ends[i], at)
        if slip[i, 0] > 0.0:
            ends[i] = reached - way * (slip[i, 1] + slip[i, 2]) / slip[i, 0]


@inlined
def ends_of(way, at, forces, slip):  # type: ignore[no-untyped-def]
    """Forces of the sliders at an angle become the angles at which they slide (in place)."""
    for i in range(slip.shape[0]):
        limit = slip[i, 1] if way > 0.0 else -slip[i, 2]
        forces[i] = at + (limit - forces[i]) / slip[i, 0] if slip[i, 0] > 0.0 else at


@inlined
def forces_of(way, at, ends, slip):  # type: ignore[no-untyped-def]
    """The other way round."""
    for i in range(slip.shape[0]):
        limit = slip[i, 1] if way > 0.0 else -slip[i, 2]
        ends[i] = limit - way * slip[i, 0] * max(way * (ends[i] - at), 0.0)

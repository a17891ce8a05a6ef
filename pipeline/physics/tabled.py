"""Smooth functions in compiled loops, from tables."""

import numpy as np
from numba import njit

PER_UNIT, ENDED = 32, 512
FAR = ENDED / PER_UNIT
TURN = 256


def _ramps() -> np.ndarray:
    """Cubics for log(1 + exp(-x)), (ENDED, 4), each over 1 / PER_UNIT of x from 0 on; to 3e-10.

    The last of them ends at 0, 1e-7 lower.
    """
    x = np.arange(ENDED + 1) / PER_UNIT
    value, slope = np.log1p(np.exp(-x)), -1.0 / (1.0 + np.exp(x)) / PER_UNIT
    value[-1] = slope[-1] = 0.0
    rise, begin, end = np.diff(value), slope[:-1], slope[1:]
    return np.column_stack([value[:-1], begin, 3.0 * rise - 2.0 * begin - end,
                            begin + end - 2.0 * rise])  # fmt: skip


RAMPS = _ramps()
WAVE = np.sin(2.0 * np.pi / TURN * np.arange(TURN + TURN // 4))

# Nothing here allocates an array, so that nothing needs to count references to one (half the time).
inlined = njit(  # type: ignore[call-overload]
    cache=True, fastmath=True, error_model="numpy", forceinline=True, _nrt=False
)


@inlined
def ramped(x):  # type: ignore[no-untyped-def]
    """log(1 + exp(x)) and its slope, 0 or x beyond FAR."""
    size = abs(x)
    if size >= FAR:
        return (x, 1.0) if x > 0.0 else (0.0, 0.0)
    k = int(size * PER_UNIT) & (ENDED - 1)  # an index of the table, whatever x is
    u = size * PER_UNIT - k
    a, b, c, d = RAMPS[k, 0], RAMPS[k, 1], RAMPS[k, 2], RAMPS[k, 3]
    value, slope = a + u * (b + u * (c + u * d)), -PER_UNIT * (b + u * (2.0 * c + u * 3.0 * d))
    return (x + value, 1.0 - slope) if x > 0.0 else (value, slope)


@inlined
def ramped_abreast(x):  # type: ignore[no-untyped-def]
    """The same, without a choice, so that several are worked out abreast; never quite 0."""
    place = min(abs(x) * PER_UNIT, ENDED - 0.001)
    k = int(place) & (ENDED - 1)
    u = place - k
    a, b, c, d = RAMPS[k, 0], RAMPS[k, 1], RAMPS[k, 2], RAMPS[k, 3]
    value, slope = a + u * (b + u * (c + u * d)), -PER_UNIT * (b + u * (2.0 * c + u * 3.0 * d))
    return max(x, 0.0) + value, (1.0 - slope if x > 0.0 else slope)


@inlined
def waved(x):  # type: ignore[no-untyped-def]
    """sin(x) and cos(x), from the nearest of TURN angles on."""
    place = x * (TURN / (2.0 * np.pi))
    nearest = np.rint(place)
    d, k = (place - nearest) * (2.0 * np.pi / TURN), int(nearest) & (TURN - 1)
    sine, cosine, square = WAVE[k], WAVE[k + TURN // 4], d * d
    along, across = 1.0 - square * (0.5 - square / 24.0), d * (1.0 - square / 6.0)
    return sine * along + cosine * across, cosine * along - sine * across

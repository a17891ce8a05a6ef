"""A hum: one frequency that holds much of what a fit leaves, in time or along a way."""

import numpy as np

LOUD = 0.1
FINELY, MOST_PLACES = 4, 1_000_000


def hum(rest: np.ndarray, along: np.ndarray) -> tuple[bool, float, float]:
    """Whether a rest (k,) hums along a coordinate (k,), the share that the hum holds, its period.

    Of independent numbers, one of k/2 frequencies holds about 2 log(k) / k (Fisher, Proc. R. Soc. A
    125 (1929) 54); noise that depends on the sample before takes a hum for its own. Samples are
    laid on the nearest places of a fine grid, so that they may be uneven or missing: the phase is
    off there by at most pi / (2 FINELY) at the highest frequency that the shortest steps show, or
    half the mean one where they are shorter still (Press and Rybicki, Astrophys. J. 338 (1989)
    277). The period is in the coordinate's unit.
    """
    count = len(rest)
    if count < 3 or not np.any(rest) or np.ptp(along) <= 0.0:
        return False, 0.0, 0.0
    span = float(np.ptp(along))
    shortest = max(float(np.quantile(np.diff(np.sort(along)), 0.05)), 0.5 * span / count)
    step = max(shortest / FINELY, span / MOST_PLACES)
    place = np.rint((along - along.min()) / step).astype(int)
    laid = np.bincount(place, weights=rest)
    highest = len(laid) // (2 * FINELY)
    power = np.abs(np.fft.rfft(laid))[1 : highest + 1] ** 2
    near = np.convolve(power, np.ones(3), mode="same")
    best = int(np.argmax(near))
    share = 2.0 * float(near[best]) / max(count * float(np.sum(rest**2)), 1e-300)
    beside = slice(max(best - 1, 0), best + 2)
    number = float(np.average(1 + np.arange(len(power))[beside], weights=power[beside]))
    period = len(laid) * step / number
    return share > LOUD + 4.0 * np.log(count) / count, min(share, 1.0), period

"""A hum: one frequency that holds much of what a fit leaves."""

import numpy as np

from pipeline.number_words import worded

LOUD = 0.1
FINELY, MOST_PLACES = 4, 1_000_000


def hum(innovations: np.ndarray, time_s: np.ndarray) -> tuple[bool, float, str]:
    """Whether innovations (k,) at times (k,) [s] hum, the share that the hum holds, and its period.

    Of independent ones, one of k/2 frequencies holds about 2 log(k) / k (Fisher, Proc. R. Soc. A
    125 (1929) 54); noise that depends on the sample before takes a hum for its own. Samples are
    laid on the nearest places of a fine grid, so that they may be uneven or missing: the phase is
    off there by at most pi / (2 FINELY) at the highest frequency that the shortest waits show
    (Press and Rybicki, Astrophys. J. 338 (1989) 277).
    """
    count = len(innovations)
    if count < 3 or not np.any(innovations):
        return False, 0.0, ""
    shortest = max(float(np.quantile(np.diff(time_s), 0.05)), 1e-300)
    step = max(shortest / FINELY, (time_s[-1] - time_s[0]) / MOST_PLACES)
    place = np.rint((time_s - time_s[0]) / step).astype(int)
    laid = np.zeros(place[-1] + 1)
    np.add.at(laid, place, innovations)
    highest = len(laid) // (2 * FINELY)
    power = np.abs(np.fft.rfft(laid))[1 : highest + 1] ** 2
    near = np.convolve(power, np.ones(3), mode="same")
    best = int(np.argmax(near))
    share = 2.0 * float(near[best]) / max(count * float(np.sum(innovations**2)), 1e-300)
    beside = slice(max(best - 1, 0), best + 2)
    number = float(np.average(1 + np.arange(len(power))[beside], weights=power[beside]))
    period = f"{worded(len(laid) * step / number)} s"
    return share > LOUD + 4.0 * np.log(count) / count, min(share, 1.0), period

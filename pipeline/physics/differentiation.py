"""Velocity and acceleration from a measured position, and the cut-off that its noise allows."""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.ndimage import median_filter

ORDER = 4
UNEVEN = 0.01
HOLE = 8.0
FEWEST_SAMPLES = 64
SEGMENT = 1024
SMOOTHED = 40
MOTION_SHARE = 0.999
NO_FILTER = 0.45
EDGE_PERIODS = 1.0
PAD_PERIODS = 3.0


@dataclass(frozen=True)
class Derivatives:
    """Position [x], velocity [x/s] and acceleration [x/s^2] of each sample, each (n,).

    cutoff_hz: of the low-pass; infinite where none was needed. rate_hz: of the even grid on which
    it worked. resampled: whether the samples stood unevenly. known: (n,) mask, False at the ends
    and beside holes, where the filter sees one side only. of_speed: whether the velocity was known.
    """

    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    cutoff_hz: float
    rate_hz: float
    resampled: bool
    known: np.ndarray
    of_speed: bool = False


def differentiate(
    time_s: np.ndarray,
    position: np.ndarray,
    cutoff_hz: float | None = None,
    speed: np.ndarray | None = None,
) -> Derivatives:
    """Low-pass a position without delay, then take central differences.

    The low-pass is a Butterworth filter of order 4, run forwards and backwards; v = (x_{k+1} -
    x_{k-1}) / 2h, a = (x_{k+1} - 2 x_k + x_{k-1}) / h^2. Of a sine of frequency f they err by
    (2 pi f h)^2 / 6 and (2 pi f h)^2 / 12 of its velocity and acceleration, the filter by
    1 - 1 / (1 + (f / cutoff)^8). Samples that stand unevenly (by more than 1 % of their median
    distance) go by way of a cubic spline to an even grid and back. Where more than HOLE samples are
    missing in a row, the two sides of the hole are ends. The cut-off is `cutoff_of` unless given.
    speed: (n,) where it is known and the position its integral: then it is low-passed itself, and
    a = (v_{k+1} - v_{k-1}) / 2h; differences of its integral would round where it turns.
    Source: Gautier, Janot and Vandanjon, IEEE Trans. Control Syst. Technol. 21 (2013) 428, section
    II-C. Raises ValueError for fewer than 3 samples or times that stand still.
    """
    apart = np.diff(time_s)
    if len(time_s) < 3 or not np.all(apart > 0.0):
        raise ValueError("at least 3 samples at rising times")
    h = float(np.median(apart))
    resampled = bool(np.max(np.abs(apart - h)) > UNEVEN * h)
    grid, x = time_s, np.asarray(position, dtype=float)
    holes = np.flatnonzero(apart > HOLE * h)
    if resampled:
        grid = np.arange(time_s[0], time_s[-1] + 0.5 * h, h)
        x = bridged(time_s, x, grid, holes)
    whole = longest_between(time_s, grid, holes)
    if speed is not None and resampled:
        speed = bridged(time_s, speed, grid, holes)
    bend = np.diff(x[whole], 2) if speed is None else np.diff(speed[whole])
    cutoff = cutoff_of(x[whole], bend, 1.0 / h) if cutoff_hz is None else cutoff_hz
    filtered = cutoff < NO_FILTER / h
    if filtered:
        x = low_passed(x, cutoff * h)
    else:
        cutoff = np.inf
    if speed is None:
        v = np.gradient(x, h, edge_order=2)
        a = np.empty_like(x)
        a[1:-1] = np.diff(x, 2) / h**2
        a[0], a[-1] = a[1], a[-2]
    else:
        v = low_passed(speed, cutoff * h) if filtered else np.asarray(speed, dtype=float)
        a = np.gradient(v, h, edge_order=2)
    edge = max(EDGE_PERIODS / cutoff, 1.5 * h)
    known = (time_s >= time_s[0] + edge) & (time_s <= time_s[-1] - edge)
    for hole in holes:
        known &= (time_s <= time_s[hole] - edge) | (time_s >= time_s[hole + 1] + edge)
    if resampled:
        x, v, a = (np.interp(time_s, grid, values) for values in (x, v, a))
    return Derivatives(x, v, a, float(cutoff), 1.0 / h, resampled, known, speed is not None)


def bridged(
    time_s: np.ndarray, position: np.ndarray, grid: np.ndarray, holes: np.ndarray
) -> np.ndarray:
    """Positions (n,) on a grid (m,) by a cubic spline, and by a line over each hole.

    holes: indices of the last samples before them. A spline would swing far out there.
    """
    out = np.asarray(CubicSpline(time_s, position)(grid))
    for hole in holes:
        inside = (grid > time_s[hole]) & (grid < time_s[hole + 1])
        out[inside] = np.interp(grid[inside], time_s, position)
    return out


def longest_between(time_s: np.ndarray, grid: np.ndarray, holes: np.ndarray) -> slice:
    """The part of a grid that lies in the longest stretch of time without a hole."""
    begin = np.concatenate([time_s[:1], time_s[holes + 1]])
    end = np.concatenate([time_s[holes], time_s[-1:]])
    longest = int(np.argmax(end - begin))
    first, last = np.searchsorted(grid, [begin[longest], end[longest]])
    return slice(int(first), int(last) + 1)


def low_passed(values: np.ndarray, cutoff: float) -> np.ndarray:
    """A zero-phase low-pass of evenly spaced values (n,); cutoff in periods a sample."""
    from scipy.signal import butter, sosfiltfilt  # 0.6 s: only forces wait for it

    sections = butter(ORDER, 2.0 * cutoff, output="sos")
    pad = min(int(PAD_PERIODS / cutoff), len(values) - 1)
    return np.asarray(sosfiltfilt(sections, values, padlen=pad))


def cutoff_of(position: np.ndarray, bend: np.ndarray, rate_hz: float) -> float:
    """Up to which frequency [Hz] differences show the motion; the rate if they do everywhere.

    bend: the position's second differences, or the first ones of a velocity that is known. Their
    spectrum falls with the motion's own and rises, as f^4 or f^2, with the noise: the cut-off is
    where it is lowest, above the frequencies that hold all but a thousandth of the position's
    variance. It is smoothed by a running median, so that a line does not count.
    """
    from scipy.signal import welch

    if len(position) < FEWEST_SAMPLES:
        return rate_hz
    segment = min(SEGMENT, len(bend))
    own = welch(position, rate_hz, nperseg=segment, detrend="linear")[1]
    frequency, power = welch(bend, rate_hz, nperseg=segment)
    power = median_filter(power, size=max(3, len(power) // SMOOTHED), mode="nearest")
    total = np.cumsum(own)
    first = 1 + int(np.searchsorted(total, MOTION_SHARE * total[-1]))
    if first >= len(power):
        return rate_hz
    return float(frequency[first + int(np.argmin(power[first:]))])

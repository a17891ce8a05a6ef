"""A drive that was measured with noise: its size, and what moved smoothly behind it."""

import numpy as np

from pipeline.discrepancy.problem.beside import may_follow
from pipeline.discrepancy.problem.counts import whittaker
from pipeline.discrepancy.problem.outliers import robust_deviation
from pipeline.physics.play_operator import play

FEWEST = 100
WHITE = 0.85
LEAST_SHARE = 0.2
STIFFNESSES = 2.0 ** np.arange(-2, 33)
ALIKE = 2.0
USUAL = 4.0
PLAYS = np.array([0.0, 1.0, 2.0, 3.0, 4.0, 6.0, 9.0, 14.0, 20.0])


def noise_of_motion(values: np.ndarray, time_s: np.ndarray | None = None) -> float:
    """Deviation of the white noise that a motion (n,) carries; 0.0 where none shows.

    Differences of white noise grow by a fixed factor from the second to the third, those of a
    smooth motion fall. Medians, so that corners and stops do not count. What is smooth in the times
    of its samples (n,) is, where these are uneven, not so from sample to sample, and carries none;
    nor does what is smooth from sample to sample where the times were taken down late.
    """
    if len(values) < FEWEST:
        return 0.0
    least = []
    for clock in clocks(len(values), time_s):
        second, third = (robust_deviation(differences(values, clock, k)) for k in (2, 3))
        least.append(third if third > WHITE * second else 0.0)
    return min(least)


def noise_of_readings(values: np.ndarray, time_s: np.ndarray) -> float:
    """Deviation of the white noise of readings (n,), at times (n,), of what moves smoothly."""
    every = clocks(len(values), time_s)
    return min(robust_deviation(differences(values, clock, 3)) for clock in every)


def clocks(count: int, time_s: np.ndarray | None) -> list[np.ndarray]:
    """By what a motion of so many samples may be smooth, (count,) each."""
    every = np.arange(count, dtype=float)
    return [every] if time_s is None or np.any(np.diff(time_s) <= 0.0) else [every, time_s]


def differences(values: np.ndarray, clock: np.ndarray, order: int) -> np.ndarray:
    """Divided differences (n - order,) of values (n,) at times (n,), which increase.

    Each scaled so that white noise keeps its deviation. They leave nothing of a polynomial of lower
    order. Source: Newton's interpolation.
    """
    rows = len(values) - order
    at = np.stack([clock[j : rows + j] for j in range(order + 1)])
    apart = at[:, None] - at
    apart[np.diag_indices(order + 1)] = 1.0
    weights = 1.0 / apart.prod(axis=1)
    weights /= np.linalg.norm(weights, axis=0)
    return np.asarray(sum(w * values[j : rows + j] for j, w in enumerate(weights)))


def behind_noise(values: np.ndarray, deviation: float) -> np.ndarray:
    """The smoothest motion (n,) from which values (n,) are no further off than their noise.

    Source: Whittaker's smoother (`counts.py`), as stiff as the discrepancy principle lets it be
    (Morozov, Soviet Math. Dokl. 7 (1966) 414).
    """
    best = values
    for stiffness in STIFFNESSES:
        smooth = whittaker(values, stiffness)
        if np.mean((smooth - values) ** 2) > deviation**2:
            break
        best = smooth
    return best


def unroughened(
    drive: np.ndarray, time_s: np.ndarray, measured: np.ndarray
) -> tuple[np.ndarray, float]:
    """What moved behind a noisy drive (n,), and its noise; or the drive and 0.0.

    time_s: (n,). measured: (n,), NaN where not measured. A drive is left as it is where the
    measurement may follow its noise, which then is motion, or where its noise is much less than the
    measurement's. Motion at random looks like noise, and a play takes it out: so the drive stays,
    too, if the measurement is as near to it behind some play as it is to the smooth one behind any.
    """
    noise = noise_of_motion(drive, time_s)
    if noise == 0.0:
        return drive, 0.0
    smooth = behind_noise(drive, noise)
    if smooth is drive:
        return drive, 0.0
    rows = np.isfinite(measured)
    gain = float(np.polyfit(smooth[rows], measured[rows], 1)[0])
    own = noise_of_readings(measured[rows], time_s[rows])
    if abs(gain) * noise < LEAST_SHARE * own:
        return drive, 0.0
    played = left_behind_play(drive, measured, noise) <= left_behind_play(smooth, measured, noise)
    followed = played or may_follow(drive - smooth, smooth, measured, USUAL)
    return (drive, 0.0) if followed else (smooth, noise)


def left_behind_play(drive: np.ndarray, measured: np.ndarray, noise: float) -> float:
    """Least root mean square that a line in a drive (n,) behind some play leaves of a measurement.

    measured: (n,), NaN where not measured. The plays go from none to PLAYS[-1] times the noise.
    """
    rows, left = np.isfinite(measured), []
    for width in PLAYS[PLAYS * noise < 0.5 * np.ptp(drive)] * noise:
        behind = play(drive, 0.5 * width, float(drive[0]))[rows]
        line = np.polyval(np.polyfit(behind, measured[rows], 1), behind)
        left.append(float(np.sqrt(np.mean((measured[rows] - line) ** 2))))
    return min(left, default=np.inf)


def behind_known_noise(values: np.ndarray, time_s: np.ndarray, deviation: float) -> np.ndarray:
    """What moved behind values (n,) at times (n,) with a noise of about `deviation`; or they."""
    own = noise_of_motion(values, time_s) if deviation > 0.0 else 0.0
    alike = deviation < ALIKE * own and own < ALIKE * deviation
    return behind_noise(values, own) if alike else values

"""What a simulation does beside its static curve, where the measurement does it as well."""

import numpy as np
from numpy.polynomial import Legendre

from pipeline.discrepancy.problem.counts import quantum_of
from pipeline.discrepancy.problem.rough import noise_of_motion, noise_of_readings
from pipeline.physics.kinematics import Curve
from pipeline.physics.motion import Motion

FEWEST, SEEN, OWN = 30, 0.05, 0.3
COUNTED, NOISY, ROUNDING = 0.2, 0.5, 1e-5
SMOOTH = 9
FOLLOWS, SURELY, NEARLY, SURE = 0.5, 2.0, 0.2, 0.07


def beside_curve(
    motion: Motion, curve: Curve, simulated: np.ndarray, measured: np.ndarray
) -> tuple[np.ndarray, bool]:
    """What a simulation has beside a static curve of its drive, (n,) each, and whether it stays.

    That a servo or a spring comes a little late, a simulation may know, too: then it is no
    mismatch. It is 0 where it is not SEEN beside the measurement's noise, where it is rounding, or
    where it may be the drive's own counts or noise, as it is as large as these make it: 0.29 of a
    count, or the noise (a command that goes in steps is on a grid, too, and exact). It stays where
    the measurement surely goes along with it; elsewhere what explains the rest has to say.
    """
    drive, nothing = motion.drive, np.zeros(len(motion))
    known = np.isfinite(simulated) & np.isfinite(measured)
    if known.sum() < FEWEST:
        return nothing, False
    found = np.where(np.isfinite(simulated), simulated - curve(drive), 0.0)
    size = float(np.std(found[known]))
    noise = noise_beside(simulated[known], measured[known], motion.time_s[known])
    slope = abs(curve.slope)
    counted, rough = slope * quantum_of(drive), slope * noise_of_motion(drive, motion.time_s)
    of_drive = COUNTED * counted < size < counted / OWN or NOISY * rough < size < rough / OWN
    least = max(SEEN * noise, ROUNDING * float(np.ptp(simulated[known])))
    if size <= least or of_drive:
        return nothing, False
    return found, goes_along(drive[known], simulated[known], measured[known])


def noise_beside(simulated: np.ndarray, measured: np.ndarray, time_s: np.ndarray) -> float:
    """Deviation of a measurement's white noise, arrays (n,) of samples that stand close or far.

    Of positions far apart, which no motion joins smoothly, what the simulation leaves may be smooth
    all the same.
    """
    return min(noise_of_readings(values, time_s) for values in (measured, measured - simulated))


def goes_along(drive: np.ndarray, simulated: np.ndarray, measured: np.ndarray) -> bool:
    """Whether a measurement surely does what a simulation leaves beside a curve, (n,) each.

    In second differences, which leave next to nothing of slow physics, or beside a cubic. The curve
    is a SMOOTH one: one through each sample follows now the way up and now the way down, and a
    measurement would seem to go along with that.
    """
    asked = Legendre.fit(drive, simulated, SMOOTH)(drive)
    left = simulated - asked
    line = np.polyval(np.polyfit(asked, measured, 1), asked)
    share, error = share_of(np.diff(left, 2)[:, None], np.diff(measured - line, 2))
    if share - SURELY * error > FOLLOWS:
        return True
    way = (asked - asked.mean()) / max(float(np.ptp(asked)), 1e-300)
    share, error = share_of(np.column_stack([left, np.vander(way, 4)]), measured)
    return abs(share - 1.0) < NEARLY and error < SURE


def share_of(columns: np.ndarray, values: np.ndarray) -> tuple[float, float]:
    """The factor of the first of columns (n, k) in a fit to values (n,), and its error."""
    factors, _, rank, _ = np.linalg.lstsq(columns, values, rcond=None)
    if rank < columns.shape[1]:
        return 0.0, np.inf
    off = float(np.std(values - columns @ factors))
    return float(factors[0]), off * float(np.sqrt(np.linalg.inv(columns.T @ columns)[0, 0]))

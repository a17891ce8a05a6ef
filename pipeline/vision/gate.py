"""A Kalman gate over a track of angles: it says which values can't be, and changes none."""

import numpy as np
from filterpy.kalman import KalmanFilter

SMALLEST_NOISE_DEG = 0.02
NORMAL_MAD = 1.4826
ROWS_TO_BELIEVE = 3
MOTION = np.array([[0.25, 0.5], [0.5, 1.0]])


def flag_outliers(
    angle_deg: np.ndarray, deviations: float, command_deg: np.ndarray | None = None
) -> np.ndarray:
    """True where a value lies more than `deviations` from where the track leads, (n,) bool.

    angle_deg: (n,) in the order of time, NaN where nothing was measured (never flagged).
    command_deg: (n,) what was told, if known: where it went further than usual, so may the angle.

    The filter's state is angle and change per row. Its noise is taken from the track: of the
    measurement from the second differences, of the motion from the usual change per row, so that a
    reversal is expected at any time. Three rows on end that contradict the track but
    not each other are a jump of the robot, no outliers: the filter starts again there.
    """
    flags = np.zeros(len(angle_deg), dtype=bool)
    noise_deg, change_deg = _usual(angle_deg)
    changes_deg = _expected(len(angle_deg), change_deg, command_deg)
    kalman: KalmanFilter | None = None
    doubted: list[int] = []
    for row, value in enumerate(angle_deg):
        if kalman is not None:
            kalman.predict(Q=changes_deg[row] ** 2 * MOTION)
        if np.isnan(value):
            if kalman is not None:
                kalman.update(None)
            continue
        if kalman is None:
            kalman = _filter_at(value, noise_deg, change_deg)
        elif abs(value - kalman.x[0, 0]) <= deviations * np.sqrt(kalman.P[0, 0] + noise_deg**2):
            kalman.update(value)
            doubted = []
        else:
            kalman.update(None)
            flags[row] = True
            doubted.append(row)
            if _agree(angle_deg[doubted[-ROWS_TO_BELIEVE:]], deviations, noise_deg, change_deg):
                flags[doubted[-ROWS_TO_BELIEVE:]] = False
                kalman, doubted = _filter_at(value, noise_deg, change_deg), []
    return flags


def _usual(angle_deg: np.ndarray) -> tuple[float, float]:
    """Noise and usual change per row of a track [deg], both robust."""
    known = angle_deg[~np.isnan(angle_deg)]
    if len(known) < 3:
        return SMALLEST_NOISE_DEG, SMALLEST_NOISE_DEG
    bends = np.diff(known, 2)
    noise_deg = NORMAL_MAD * float(np.median(np.abs(bends))) / np.sqrt(6.0)
    change_deg = float(np.median(np.abs(np.diff(known))))
    return max(noise_deg, SMALLEST_NOISE_DEG), max(change_deg, SMALLEST_NOISE_DEG)


def _expected(count: int, change_deg: float, command_deg: np.ndarray | None) -> np.ndarray:
    """Change of the angle to be expected at each row [deg], (count,): at least the usual one.

    A long way makes the track lead on too far for some rows.
    """
    if command_deg is None:
        return np.full(count, change_deg)
    way_deg = np.abs(np.diff(command_deg, prepend=command_deg[:1]))
    before = [np.append(np.zeros(k), way_deg)[:count] for k in range(ROWS_TO_BELIEVE)]
    return np.maximum(np.max(before, axis=0), change_deg)


def _filter_at(value_deg: float, noise_deg: float, change_deg: float) -> KalmanFilter:
    kalman = KalmanFilter(dim_x=2, dim_z=1)
    kalman.x = np.array([[value_deg], [0.0]])
    kalman.F = np.array([[1.0, 1.0], [0.0, 1.0]])
    kalman.H = np.array([[1.0, 0.0]])
    kalman.P = np.diag([noise_deg**2, change_deg**2])
    kalman.R = np.array([[noise_deg**2]])
    return kalman


def _agree(values: np.ndarray, deviations: float, noise_deg: float, change_deg: float) -> bool:
    if len(values) < ROWS_TO_BELIEVE:
        return False
    allowed_deg = deviations * np.hypot(np.sqrt(2.0) * noise_deg, change_deg)
    return bool(np.all(np.abs(np.diff(values)) <= allowed_deg))

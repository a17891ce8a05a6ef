"""The coordinates along which a residual may lie, each as columns to fit it to."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from pipeline.physics.motion import Motion
from pipeline.recording import branch_of, reversals_of

KNOTS = 9
FINE_KNOTS = 49
TIME_KNOTS = 24
SAMPLES_A_KNOT = 8
SAME_DWELL = 0.1


@dataclass(frozen=True)
class Ground:
    """What every sample's residual may depend on, each array of shape (n,).

    direction: +1 ascending, -1 descending, 0 never moved. travel: of the drive since its last
    reversal, NaN before the first one [drive unit]. dwell_s: how long the drive stood before the
    sample. rate: speed of the drive, without sign [drive unit/s]. position: where the sensor sees
    the body, by the simulation [measurement's unit]. others_direction: as direction, for each of
    the other commands.
    """

    drive: np.ndarray
    time_s: np.ndarray
    cycle: np.ndarray
    direction: np.ndarray
    travel: np.ndarray
    dwell_s: np.ndarray
    rate: np.ndarray
    position: np.ndarray
    others: Mapping[str, np.ndarray] = field(default_factory=dict)
    others_direction: Mapping[str, np.ndarray] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.drive)

    def rows(self, wanted: np.ndarray) -> "Ground":
        """Only the wanted samples, by index or mask."""
        return replace(
            self,
            **{n: getattr(self, n)[wanted] for n in self.__dataclass_fields__ if "other" not in n},
            others={n: v[wanted] for n, v in self.others.items()},
            others_direction={n: v[wanted] for n, v in self.others_direction.items()},
        )

    @property
    def step(self) -> float:
        """Median step of the drive where it moves [drive unit]."""
        steps = np.abs(np.diff(self.drive))
        return float(np.median(steps[steps > 0])) if np.any(steps > 0) else 0.0


def ground_of(motion: Motion, position: np.ndarray) -> Ground:
    """Coordinates of every sample of a motion; position: (n,) simulated measurement."""
    drive = np.asarray(motion.drive, dtype=float)
    dwell_s = _dwell_s(motion.time_s)
    moved = np.abs(np.diff(drive, prepend=drive[:1]))
    rate = np.divide(moved, dwell_s, out=np.zeros(len(drive)), where=dwell_s > 0)
    others = {n: np.asarray(v, dtype=float) for n, v in motion.others.items() if np.ptp(v) > 0}
    return Ground(
        drive=drive,
        time_s=np.asarray(motion.time_s, dtype=float),
        cycle=np.asarray(motion.cycle),
        direction=branch_of(drive).astype(float),
        travel=_travel(drive),
        dwell_s=dwell_s,
        rate=rate,
        position=np.asarray(position, dtype=float),
        others=others,
        others_direction={n: branch_of(v).astype(float) for n, v in others.items()},
    )


def _dwell_s(time_s: np.ndarray) -> np.ndarray:
    gaps = np.diff(np.asarray(time_s, dtype=float))
    return np.concatenate([[np.median(gaps)], gaps]) if len(gaps) else np.ones(len(time_s))


def _travel(drive: np.ndarray) -> np.ndarray:
    travel = np.full(len(drive), np.nan)
    turns = reversals_of(drive)
    if len(turns):
        last = turns[np.searchsorted(turns, np.arange(turns[0] + 1, len(drive)), side="left") - 1]
        travel[turns[0] + 1 :] = np.abs(drive[turns[0] + 1 :] - drive[last])
    return travel


def hats(values: np.ndarray, knots: np.ndarray) -> np.ndarray:
    """Piecewise linear hat functions on rising knots, shape (n, len(knots)); NaN gives zeros."""
    known = np.where(np.isfinite(values), values, knots[0])
    inside = np.clip(known, knots[0], knots[-1])
    left = np.clip(np.searchsorted(knots, inside, side="right") - 1, 0, len(knots) - 2)
    share = (inside - knots[left]) / (knots[left + 1] - knots[left])
    out = np.zeros((len(values), len(knots)))
    rows = np.arange(len(values))
    out[rows, left] = 1.0 - share
    out[rows, left + 1] = share
    out[~np.isfinite(values)] = 0.0
    return out


def even_knots(values: np.ndarray, count: int) -> np.ndarray:
    """Evenly spaced knots over the range, fewer for few samples or few different values."""
    distinct = len(np.unique(values))
    count = min(count, distinct, max(2, len(values) // SAMPLES_A_KNOT))
    return np.linspace(float(np.min(values)), float(np.max(values)), max(count, 2))


def varies(values: np.ndarray) -> bool:
    """Whether values differ by more than rounding."""
    return len(values) > 1 and bool(np.ptp(values) > 1e-9 * max(1e-300, np.max(np.abs(values))))


def command_columns(ground: Ground, fine: bool) -> np.ndarray:
    """Functions of the drive alone, (n, k): smooth ones, or fine enough to show a ripple."""
    if not varies(ground.drive):
        return np.zeros((len(ground), 0))
    count = KNOTS
    if fine:
        finest = int(np.ptp(ground.drive) / max(2.0 * ground.step, 1e-12)) + 1
        count = int(np.clip(finest, KNOTS, FINE_KNOTS))
    return hats(ground.drive, even_knots(ground.drive, count))


def direction_columns(ground: Ground) -> np.ndarray:
    """The direction of travel, (n, 1), empty where the drive never turns."""
    turned = np.any(ground.direction > 0) and np.any(ground.direction < 0)
    return ground.direction[:, None] if turned else np.zeros((len(ground), 0))


def travel_columns(ground: Ground) -> np.ndarray:
    """What fades with travel after a reversal, alike and opposite for both directions, (n, k)."""
    known = np.isfinite(ground.travel)
    span = float(np.max(ground.travel[known])) if np.any(known) else 0.0
    if span <= 0.0:
        return np.zeros((len(ground), 0))
    first = max(ground.step, 0.005 * span)
    steps = np.concatenate([[0.0], first * 2.0 ** np.arange(12)])
    knots = np.append(steps[steps < 0.75 * span], span)
    fading = hats(ground.travel, knots)[:, :-1]
    return with_direction(fading, ground.direction)


def loop_columns(ground: Ground) -> np.ndarray:
    """The rest of a loop that cycles repeat: direction times functions of the drive, (n, k)."""
    if not direction_columns(ground).shape[1]:
        return np.zeros((len(ground), 0))
    columns = command_columns(ground, fine=False)
    return ground.direction[:, None] * (columns - columns.mean(axis=0))


def dwell_columns(ground: Ground) -> np.ndarray:
    """Functions of the logarithm of the dwell, with and without direction; empty at one dwell."""
    usual = float(np.median(ground.dwell_s))
    other = np.abs(ground.dwell_s - usual) > SAME_DWELL * usual
    if usual <= 0 or np.mean(other) < 0.02:
        return np.zeros((len(ground), 0))
    level = np.log(np.clip(ground.dwell_s, 0.01 * usual, 100.0 * usual))
    return with_direction(hats(level, _spread_knots(level)), ground.direction)


def rate_columns(ground: Ground) -> np.ndarray:
    """Functions of the drive's speed, with and without direction; empty at one speed."""
    usual = float(np.median(ground.rate))
    other = np.abs(ground.rate - usual) > SAME_DWELL * max(usual, 1e-300)
    if not varies(ground.rate) or np.mean(other) < 0.05:
        return np.zeros((len(ground), 0))
    top = float(np.quantile(ground.rate, 0.995))
    level = np.minimum(ground.rate, top)
    if not varies(level):
        return np.zeros((len(ground), 0))
    return with_direction(hats(level, _spread_knots(level)), ground.direction)


def other_columns(ground: Ground, name: str) -> np.ndarray:
    """Functions of another command and of its direction, (n, k); empty where it stands still."""
    command = ground.others[name]
    if not varies(command):
        return np.zeros((len(ground), 0))
    around = hats(command, even_knots(command, KNOTS))
    return np.hstack([around, ground.others_direction[name][:, None]])


def position_columns(ground: Ground) -> np.ndarray:
    """Functions of where the sensor sees the body; empty where that is unknown or fixed."""
    if not np.all(np.isfinite(ground.position)) or not varies(ground.position):
        return np.zeros((len(ground), 0))
    return hats(ground.position, even_knots(ground.position, KNOTS))


def time_columns(ground: Ground) -> np.ndarray:
    """Slow functions of time, about two pieces a cycle, (n, k)."""
    if not varies(ground.time_s):
        return np.zeros((len(ground), 0))
    count = int(np.clip(2 * len(np.unique(ground.cycle)) + 1, 5, TIME_KNOTS))
    return hats(ground.time_s, even_knots(ground.time_s, count))


def cycle_columns(cycle: np.ndarray) -> np.ndarray:
    """One column for each cycle, (n, cycles); zeros and ones."""
    return (cycle[:, None] == np.unique(cycle)[None, :]).astype(float)


def _spread_knots(level: np.ndarray) -> np.ndarray:
    knots = np.unique(np.quantile(level, [0.0, 0.1, 0.5, 0.9, 1.0]))
    apart = np.concatenate([[True], np.diff(knots) > 0.02 * np.ptp(knots)])
    kept = knots[apart]
    return kept if len(kept) > 1 else np.array([knots[0], knots[-1]])


def with_direction(columns: np.ndarray, direction: np.ndarray) -> np.ndarray:
    """Columns (n, k) alike for both directions, and opposite ones clear of direction itself."""
    return np.hstack([direction[:, None] * (columns - columns.mean(axis=0)), columns])

"""The nominal curve: what the kinematics alone make of the drive."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numba import njit

EDGE = 10
REACH = 1.2


class Curve(Protocol):
    """A static, smooth map from the drive to the joint angle, and its mean slope."""

    @property
    def slope(self) -> float: ...

    def __call__(self, drive: np.ndarray) -> np.ndarray: ...

    def spared(self, drive: np.ndarray, middle: float, half: float) -> np.ndarray:
        """How much more a drive asks for than its line of mean slope once it is past a dead way.

        That way is lost from `middle` on, up to `half` [drive unit] either way; (n,).
        """
        lost = np.minimum(np.maximum(drive - middle, -half), half)
        return self(drive - lost) + self.slope * lost - self(drive)


@dataclass(frozen=True)
class CubicCurve(Curve):
    """angle = gain * drive - cubic * drive^3 (a tendon-driven bend that saturates mildly)."""

    gain: float = 0.7
    cubic: float = 0.0

    @property
    def slope(self) -> float:
        return self.gain

    def __call__(self, drive: np.ndarray) -> np.ndarray:
        return drive * (self.gain - self.cubic * drive * drive)


@dataclass(frozen=True)
class IdentityCurve(Curve):
    """The drive is already in the joint's own angle (a simulation's trace)."""

    slope: float = 1.0

    def __call__(self, drive: np.ndarray) -> np.ndarray:
        return np.asarray(drive, dtype=float)


@njit(cache=True)
def _at(place, angle, low_slope, high_slope):  # type: ignore[no-untyped-def]
    last = angle.size - 1
    if place <= 0.0:
        return angle[0] + place * low_slope
    if place >= last:
        return angle[last] + (place - last) * high_slope
    k = int(place)
    return angle[k] + (place - k) * (angle[k + 1] - angle[k])


@njit(cache=True)
def _between(drive, first, spacing, angle, low_slope, high_slope):  # type: ignore[no-untyped-def]
    out, each = np.empty(drive.size), 1.0 / spacing
    for i in range(drive.size):
        out[i] = _at((drive[i] - first) * each, angle, low_slope, high_slope)
    return out


@njit(cache=True)
def _spared(drive, middle, half, slope, first, spacing, angle, low_slope, high_slope):  # type: ignore[no-untyped-def]
    out, each = np.empty(drive.size), 1.0 / spacing
    for i in range(drive.size):
        lost = min(max(drive[i] - middle, -half), half)
        left = _at((drive[i] - lost - first) * each, angle, low_slope, high_slope)
        whole = _at((drive[i] - first) * each, angle, low_slope, high_slope)
        out[i] = left + slope * lost - whole
    return out


@dataclass(frozen=True)
class SampledCurve(Curve):
    """A curve through evenly spaced samples, straight beyond its ends.

    first, spacing: where the samples stand [drive unit]. angle: (k,), k >= 2.
    """

    first: float
    spacing: float
    angle: np.ndarray

    @cached_property
    def slope(self) -> float:
        return float(self.angle[-1] - self.angle[0]) / (self.spacing * (len(self.angle) - 1))

    @cached_property
    def _beyond(self) -> tuple[float, float]:
        """Slopes below and above the samples [angle unit/spacing]."""
        edge = min(EDGE, len(self.angle) - 1)
        low, high = self.angle[edge] - self.angle[0], self.angle[-1] - self.angle[-1 - edge]
        return float(low / edge), float(high / edge)

    def __call__(self, drive: np.ndarray) -> np.ndarray:
        drive = np.ascontiguousarray(drive, dtype=float)
        return _between(drive, self.first, self.spacing, self.angle, *self._beyond)

    def spared(self, drive: np.ndarray, middle: float, half: float) -> np.ndarray:
        drive, knots = np.ascontiguousarray(drive, dtype=float), (self.first, self.spacing)
        return _spared(drive, middle, half, self.slope, *knots, self.angle, *self._beyond)


def sampled_curve(drive: np.ndarray, angle: np.ndarray, knots: int = 401) -> SampledCurve:
    """The curve through samples (n,), (n,) in any order; equal drives are averaged."""
    at, place = np.unique(drive, return_inverse=True)
    mean = np.bincount(place, weights=angle) / np.bincount(place)
    grid = np.linspace(at[0], at[-1], knots)
    return SampledCurve(float(grid[0]), float(grid[1] - grid[0]), np.interp(grid, at, mean))


def straightened(curve: Curve, drive: np.ndarray) -> SampledCurve:
    """The straight line that is nearest to a curve over drives (n,)."""
    ends = np.array([drive.min(), drive.max()])
    return sampled_curve(ends, np.polyval(np.polyfit(drive, curve(drive), 1), ends))


@dataclass(frozen=True)
class Beside:
    """Another command that a smooth error depends on; middle, half_range: of its values."""

    command: str
    middle: float
    half_range: float


@dataclass(frozen=True)
class SmoothError:
    """A smooth error of a curve: Legendre polynomials of orders 2 to 4 over its range.

    middle, half_range: of the angle. weights: size of each at an end of the range; a fifth of the
    range beyond its ends it stays as it is there. beside: other commands, orders 1 to 4 of each;
    their weights, (3 + 4 per command,) in all, follow in their order.
    """

    middle: float
    half_range: float
    weights: tuple[float, ...]
    beside: tuple[Beside, ...] = ()

    def __call__(self, angle: np.ndarray, others: Mapping[str, np.ndarray]) -> np.ndarray:
        columns = smooth_columns(angle, others, self.middle, self.half_range, self.beside)
        return columns @ np.array(self.weights)


def smooth_columns(
    angle: np.ndarray,
    others: Mapping[str, np.ndarray],
    middle: float,
    half_range: float,
    beside: Sequence[Beside],
) -> np.ndarray:
    """What the weights of a smooth error multiply, (n, 3 + 4 per command)."""
    columns = [legendre((angle - middle) / half_range)]
    for other in beside:
        place = (others[other.command] - other.middle) / other.half_range
        columns += [np.clip(place, -REACH, REACH)[:, None], legendre(place)]
    return columns[0] if len(columns) == 1 else np.hstack(columns)


@njit(cache=True)
def legendre(x: np.ndarray) -> np.ndarray:
    """Legendre polynomials of orders 2 to 4, shape (n, 3), of x (n,) held within +-REACH."""
    out = np.empty((x.size, 3))
    for i in range(x.size):
        held = min(max(x[i], -REACH), REACH)
        square = held * held
        out[i, 0] = 1.5 * square - 0.5
        out[i, 1] = held * (2.5 * square - 1.5)
        out[i, 2] = (4.375 * square - 3.75) * square + 0.375
    return out

"""The nominal curve: what the kinematics alone make of the drive."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np


class Curve(Protocol):
    """A static, smooth map from the drive to the joint angle."""

    def __call__(self, drive: np.ndarray) -> np.ndarray: ...


@dataclass(frozen=True)
class CubicCurve:
    """angle = gain * drive - cubic * drive^3 (a tendon-driven bend that saturates mildly)."""

    gain: float = 0.7
    cubic: float = 0.0

    def __call__(self, drive: np.ndarray) -> np.ndarray:
        return drive * (self.gain - self.cubic * drive * drive)


@dataclass(frozen=True)
class IdentityCurve:
    """The drive is already in the joint's own angle (a simulation's trace)."""

    def __call__(self, drive: np.ndarray) -> np.ndarray:
        return np.asarray(drive, dtype=float)


@dataclass(frozen=True)
class SampledCurve:
    """A curve through samples, straight beyond its ends.

    drive: (k,) increasing. angle: (k,).
    """

    drive: np.ndarray
    angle: np.ndarray

    def __call__(self, drive: np.ndarray) -> np.ndarray:
        inside = np.interp(drive, self.drive, self.angle)
        first = (self.angle[1] - self.angle[0]) / (self.drive[1] - self.drive[0])
        last = (self.angle[-1] - self.angle[-2]) / (self.drive[-1] - self.drive[-2])
        below = np.minimum(drive - self.drive[0], 0.0) * first
        above = np.maximum(drive - self.drive[-1], 0.0) * last
        return inside + below + above

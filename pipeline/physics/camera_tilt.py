"""Camera tilt: the angle is seen in projection."""

import numpy as np
from numba import njit

from pipeline.physics.force_units import RADIAN
from pipeline.physics.motion import Motion
from pipeline.physics.tabled import waved
from pipeline.physics.term import NO_STATE, Parameter, Surroundings, Term


@njit(cache=True, fastmath=True, error_model="numpy")
def _legs(angle, squeeze, direction):  # type: ignore[no-untyped-def]
    """Lengths across a direction, squeezed, and along it, of unit arms at angles (n,)."""
    across, along = np.empty(angle.size), np.empty(angle.size)
    for i in range(angle.size):
        sine, cosine = waved(angle[i] - direction)
        across[i], along[i] = squeeze * sine, cosine
    return across, along


def projected(angle_rad: np.ndarray, foreshortening: float, direction_rad: float) -> np.ndarray:
    """Angle in an image in which lengths across `direction_rad` are shortened by a factor."""
    seen = np.arctan2(*_legs(np.ascontiguousarray(angle_rad), foreshortening, direction_rad))
    home = np.arctan2(-foreshortening * np.sin(direction_rad), np.cos(direction_rad))
    place = seen - home + np.pi
    if place.size and not 0.0 <= place.min() <= place.max() < 2.0 * np.pi:
        place = np.remainder(place, 2.0 * np.pi)
    return place - np.pi


class CameraTilt(Term):
    """tan(seen - d) = cos(tilt) tan(theta - d): seen by a camera that is tilted about direction d.

    Measured from the base line, which is seen in the same projection. Source: orthographic
    projection of a rotated plane.
    """

    name = "camera_tilt"
    site = "sensor"
    place = 210.0
    group = "bend"
    means = "the camera sees the plane of motion from the side"
    says = (
        "The camera looks at the plane of motion from {tilt} off, so that angles are foreshortened."
    )

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        return (
            Parameter("tilt", "rad", 0.0, 1.1, 0.2, 0.2),
            Parameter("direction", "rad", -np.pi, np.pi, 0.0, 0.0),
        )

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        seen = projected(signal / motion.radian, float(np.cos(values[0])), float(values[1]))
        return seen * motion.radian, NO_STATE

    def scaled(self, values: np.ndarray, factor: float) -> np.ndarray:
        out = super().scaled(values, np.sqrt(abs(factor)))
        if factor < 0.0:
            out[1] += 0.5 * np.pi if out[1] < 0.0 else -0.5 * np.pi
        return out

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        return np.array([[0.2, d] for d in np.arange(-4, 4) * np.pi / 8.0])

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        return around.angle_unit in RADIAN and around.drive_span > 0.0

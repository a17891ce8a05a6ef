"""Lens distortion: an error that grows with the angle in the image."""

import numpy as np
from numba import njit

from pipeline.physics.force_units import FORCES
from pipeline.physics.motion import Motion
from pipeline.physics.term import NO_STATE, Parameter, Surroundings, Term


@njit(cache=True)
def distorted(angle, third, fifth, centre):  # type: ignore[no-untyped-def]
    """angle + third (off^3 + centre^3) + fifth (off^5 + centre^5), off = angle - centre; (n,)."""
    out, square = np.empty(angle.size), centre * centre
    still = centre * square * (third + fifth * square)
    for i in range(angle.size):
        off = angle[i] - centre
        out[i] = angle[i] + off * off * off * (third + fifth * off * off) + still
    return out


class LensDistortion(Term):
    """seen = theta + k ((theta - c)^3 + c^3): radial distortion about the angle c.

    k [1/angle unit^2] is positive for a pincushion. Form "second": k_2 ((theta - c)^5 + c^5)
    besides. Source: first radial terms of Brown, Photogrammetric Engineering 32(3) (1966) 444,
    along the arc of the marker.
    """

    name = "lens_distortion"
    site = "sensor"
    place = 220.0
    group = "bend"
    means = "an error that grows with the angle in the image"
    says = "The lens bends the image, so that the error grows towards its edge."

    def __init__(self, form: str = "first") -> None:
        self.form = form

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        half, unit = 0.5 * around.angle_span, around.angle_unit
        most = 0.3 / half**2
        own = (
            Parameter("distortion", f"1/{unit}^2", -most, most, 0.05 * most, 0.1 * most),
            Parameter("centre", unit, -1.5 * half, 1.5 * half, 0.0, 0.2 * half),
        )
        if self.form == "first":
            return own
        most = 0.3 / half**4
        return (*own, Parameter("distortion_2", f"1/{unit}^4", -most, most, 0.0, 0.1 * most))

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        k, centre = values[:2]
        fifth = values[2] if len(values) > 2 else 0.0
        return distorted(np.ascontiguousarray(signal), k, fifth, centre), NO_STATE

    def scaled(self, values: np.ndarray, factor: float) -> np.ndarray:
        return values * [factor, 1.0, factor][: len(values)]

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        """Not of a force: no lens shows it."""
        return around.angle_unit not in FORCES and super().excited(motion, around)

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        half = 0.5 * around.angle_span
        centres = half * np.array([-0.7, -0.2, 0.0, 0.2, 0.7])
        if self.form == "first":
            return np.array([[0.02 / half**2, c] for c in centres])
        sizes = np.array([[0.02, -0.006], [-0.02, 0.006]]) / [half**2, half**4]
        return np.array([[first, c, second] for first, second in sizes for c in centres])

"""Lens distortion: an error that grows with the angle in the image."""

import numpy as np

from pipeline.physics.motion import Motion
from pipeline.physics.term import NO_STATE, Parameter, Surroundings, Term


class LensDistortion(Term):
    """seen = theta + k ((theta - c)^3 + c^3): radial distortion about the angle c.

    k [1/angle unit^2] is positive for a pincushion. Source: first radial term of Brown,
    Photogrammetric Engineering 32(3) (1966) 444, along the arc of the marker.
    """

    name = "lens_distortion"
    site = "sensor"
    group = "bend"
    says = "The lens bends the image, so that the error grows towards its edge."

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        half, unit = 0.5 * around.angle_span, around.angle_unit
        most = 0.3 / half**2
        return (
            Parameter("distortion", f"1/{unit}^2", -most, most, 0.05 * most, 0.1 * most),
            Parameter("centre", unit, -1.5 * half, 1.5 * half, 0.0, 0.2 * half),
        )

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        k, centre = values
        off = signal - centre
        return signal + k * (off * off * off + centre**3), NO_STATE

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        half = 0.5 * around.angle_span
        return np.array([[0.02 / half**2, c * half] for c in (-0.7, -0.2, 0.2, 0.7)])

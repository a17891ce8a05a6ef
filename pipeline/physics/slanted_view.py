"""A line of motion that a camera sees aslant: what is farther away looks shorter."""

import numpy as np

from pipeline.physics.camera_tilt import CameraTilt
from pipeline.physics.force_units import LENGTHS
from pipeline.physics.motion import Motion
from pipeline.physics.term import NO_STATE, Parameter, Surroundings, Term

DEEPEST, STARTS = 0.7, (-0.3, 0.3)


class SlantedView(Term):
    """seen = x / (1 + slant x): a length on a line that goes away from the camera.

    slant is the sine of the tilt over the camera's distance. Gain and offset of the calibration do
    the rest. Source: pinhole projection of a line (Hartley and Zisserman, Multiple View Geometry
    (2004), section 2.5).
    """

    name = CameraTilt.name
    site = CameraTilt.site
    form = "slanted"
    place = CameraTilt.place
    group = CameraTilt.group
    means = CameraTilt.means
    says = (
        "The camera sees the line of motion aslant: lengths shrink by {slant} from place to place."
    )

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        deepest = DEEPEST / farthest(around)
        usual = 0.3 * deepest
        return (Parameter("slant", f"1/{around.angle_unit}", -deepest, deepest, 0.0, usual),)

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        return signal / (1.0 + values[0] * signal), NO_STATE

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        return np.array([[share / farthest(around)] for share in STARTS])

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        return around.angle_unit in LENGTHS and around.drive_span > 0.0


def farthest(around: Surroundings) -> float:
    """How far from 0 the joint comes [angle unit]."""
    ends = abs(around.angle_low), abs(around.angle_low + around.angle_span)
    return max(*ends, 1e-300)

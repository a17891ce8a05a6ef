"""Lag of a simulated damper: it stands behind a spring, which the simulation takes for rigid."""

from dataclasses import replace

import numpy as np

from pipeline.physics.force_term import ForceTerm
from pipeline.physics.motion import Kinetics, Motion
from pipeline.physics.term import Parameter, Surroundings
from pipeline.physics.viscous_friction import ViscousFriction

SPRUNG = ViscousFriction("sprung")


class LateDamper(ForceTerm):
    """F = damping (w - v), w + relaxation w' = v: a damper behind a spring less the rigid one.

    What the simulation has as damping * v comes late: a spring of damping / relaxation stands in
    series with it. Beside the rigid damper of the simulation, whose gain is calibration, no other
    friction by the speed says that. Source: Maxwell, Phil. Trans. 157 (1867) 49.
    """

    name = "response_lag"
    form = "damper"
    place = 125.0
    says = (
        "The damper that is simulated gives way behind a spring: {damping} of it come late, with a "
        "time constant of {relaxation}."
    )

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        damping, *others = SPRUNG.parameters(around)
        return replace(damping, low=0.0, start=max(damping.start, 0.0)), *others

    def force(
        self, motion: Motion, kinetics: Kinetics, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray | None]:
        late, after = SPRUNG.force(motion, kinetics, values, state)
        return late - values[0] * kinetics.velocity, after

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        return SPRUNG.candidates(motion, around)

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        """Where the simulation resists a motion."""
        return around.resisting and super().excited(motion, around)

"""What terms of force against motion share: their units, and how they add to the force."""

from dataclasses import replace
from typing import ClassVar

import numpy as np

from pipeline.errors import refusal
from pipeline.number_words import worded
from pipeline.physics.motion import Kinetics, Motion
from pipeline.physics.term import NO_STATE, Parameter, Surroundings, Term, TermError

KNOWN_UNITS = {
    "N s^2/m": "kg",
    "kN s^2/m": "t",
    "N s^2/mm": "t",
    "Nm s^2/rad": "kg m^2",
}
ASYMMETRY = Parameter("asymmetry", "", -0.95, 0.95, 0.0, 0.3)


class ForceTerm(Term):
    """A force of a motion, added to what the simulation says.

    Its first parameter is its size; `usual` of the measured force's range is a usual one.
    directed: whether it resists a motion, so that its two directions may differ.
    """

    site: ClassVar[str] = "body"
    adds = True
    usual: ClassVar[float] = 0.05
    directed: ClassVar[bool] = False

    def force(
        self, motion: Motion, kinetics: Kinetics, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray | None]:
        """The force [measurement's unit], (n,), and the state to carry."""
        raise NotImplementedError

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        if motion.kinetics is None:
            raise TermError(
                refusal(f"term {self.name!r}", "a force measured against a position",
                        "a motion without velocity and acceleration",
                        "Name it for a recording whose measurement is a force.")
            )  # fmt: skip
        force, after = self.force(motion, motion.kinetics, values, state)
        return signal + force, NO_STATE if after is None else after

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        return motion.kinetics is not None and around.drive_span > 0.0


def size(name: str, unit: str, most: float, around: Surroundings, usual: float = 0.05) -> Parameter:
    """A size from 0 to `most`; a correction to what the simulation says may also be negative."""
    low = -most if around.simulated else 0.0
    return Parameter(name, unit, low, most, usual * most, usual * most)


def resistance(name: str, unit: str, most: float, around: Surroundings) -> Parameter:
    """The size of a friction: only where the simulation has some may there be too much of it."""
    return size(name, unit, most, replace(around, simulated=around.resisting))


def per(around: Surroundings, seconds: int) -> str:
    """The unit of a force by a derivative of the position: `N/m`, `N s/m`, `kg`."""
    by_time = ("", " s", " s^2")[seconds]
    unit = f"{around.angle_unit}{by_time}/{around.drive_unit}"
    return KNOWN_UNITS.get(unit, unit)


def both_ways(mean: float, asymmetry: float, unit: str) -> str:
    """`27 N s/m rising and 35 N s/m falling`; `27 N s/m` where they are the same."""
    if asymmetry == 0.0:
        return f"{worded(abs(mean))} {unit}"
    rising, falling = (abs(mean * (1.0 + s * asymmetry)) for s in (1.0, -1.0))
    return f"{worded(rising)} {unit} rising and {worded(falling)} {unit} falling"

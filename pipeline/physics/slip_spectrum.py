"""Friction of slip elements of any strengths, as a simulation may have it."""

import numpy as np

from pipeline.number_words import worded
from pipeline.physics.balance import Load
from pipeline.physics.friction import Friction
from pipeline.physics.motion import Motion
from pipeline.physics.pre_sliding import slipped
from pipeline.physics.term import Parameter, Surroundings, Term

AT_JOINT, AT_DRIVE = "spectrum", "driven spectrum"
ELEMENTS, SHORTEST = 32, 1e-3


class SlipSpectrum(Term):
    """Slip elements, each as strong as it is, in the balance at the joint or at the drive.

    Element i holds by at most `hold_i` and yields after a reach, on a geometric grid from
    `shortest` to `longest`. In form "driven spectrum" x = u - sum of what they hold. It is no
    candidate of a search: only a simulation, which has no noise, shows so much of its friction.
    Source: Iwan, J. Appl. Mech. 33 (1966) 893; Visintin, Differential Models of Hysteresis (1994).
    """

    name = Friction.name
    site = Friction.site
    form = AT_JOINT
    place = Friction.place
    remembers = "way"
    says = "Friction holds the wire back by {width} between the two ways."

    def __init__(self, form: str = "") -> None:
        super().__init__(form)
        self.before_curve = self.form == AT_DRIVE
        self.in_balance = not self.before_curve

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        driven = self.before_curve
        unit, span = (
            (around.drive_unit, around.drive_span)
            if driven
            else (around.angle_unit, around.angle_span)
        )
        return (
            Parameter("shortest", unit, 0.0, span, SHORTEST * span, 0.0, at_drive=driven),
            Parameter("longest", unit, 0.0, span, span, 0.0, at_drive=driven),
            *(
                Parameter(f"hold_{i}", unit, 0.0, span, 0.0, 0.0, at_drive=driven)
                for i in range(1, ELEMENTS + 1)
            ),
        )

    def load(self, values: np.ndarray, motion: Motion, state: np.ndarray | None) -> Load:
        reaches, holds = elements_of(values)
        return Load(slip=np.column_stack([holds / reaches, holds, holds, np.zeros(len(holds))]))

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        reaches, holds = elements_of(values)
        if not len(holds):
            return signal, np.zeros(0)
        carried = [None] * len(holds) if state is None else np.split(state, len(holds))
        shares, after = zip(
            *(slipped(signal, reaches[i : i + 1], one) for i, one in enumerate(carried)),
            strict=True,
        )
        return signal - holds @ np.array(shares), np.concatenate(after)

    def sentence(self, values: np.ndarray, around: Surroundings) -> str:
        unit = self.parameters(around)[0].unit
        return self.says.format(width=f"{worded(2.0 * elements_of(values)[1].sum())} {unit}")


def reaches_from(shortest: float, longest: float) -> np.ndarray:
    """Reaches of all elements, (ELEMENTS,)."""
    return np.geomspace(shortest, longest, ELEMENTS)


def shares_of(position: np.ndarray, reaches: np.ndarray) -> np.ndarray:
    """What share of its hold each element of reaches (k,) has, at positions (n,): (n, k)."""
    return np.column_stack([slipped(position, np.array([r]), None)[0] for r in reaches])


def elements_of(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Reaches and holds of the elements that hold anything, (k,) each."""
    holds = values[2:]
    kept = holds > 0.0
    return reaches_from(values[0], values[1])[kept], holds[kept]

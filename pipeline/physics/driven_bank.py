"""Friction that the drive bends, of a distribution of slip elements."""

from typing import ClassVar

import numpy as np

from pipeline.physics.friction import Friction
from pipeline.physics.motion import Motion
from pipeline.physics.pre_sliding import ELEMENTS, slipped, weighted
from pipeline.physics.term import Parameter, Surroundings

BANK, ASYMMETRIC = "driven bank", "driven bank asymmetric"
LIGHTEST, HEAVIEST = 0.3, 3.0


class DrivenBank(Friction):
    """x = u - width / 2 z(u), z being the share that acts of stops in parallel at the drive u.

    Prandtl and Ishlinskii's operator, as models of tendons in sheaths have it: small loops lie
    closed within the large ones. Stop i gives way after reach_i (see `stops_of`), over no shorter
    ones than keep the joint from moving against the drive. In the asymmetric form it holds back
    more in one direction than in the other. What loads the joint behind it does not change it.
    Stops that are all alike are none of it: as firm as the drive, they are play.
    Source: Visintin, Differential Models of Hysteresis (1994); Al Janaideh, Rakheja and Su,
    IEEE/ASME Trans. Mechatronics 16 (2011) 734.
    """

    grows: ClassVar = {BANK: (ASYMMETRIC,)}
    apart = "in the sheath"
    says = (
        "In its sheath friction holds the wire back by {width} between the two ways, and gives way "
        "gradually over the first {reach} of motion."
    )

    def __init__(self, form: str = BANK) -> None:
        super().__init__(form)
        self.before_curve, self.in_balance = True, False

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        unit, span = around.drive_unit, around.drive_span
        own = (
            Parameter("width", unit, 0.0, 0.9 * span, 0.05 * span, 0.05 * span, at_drive=True),
            Parameter("reach", unit, 1e-3 * span, span, 0.05 * span, 0.05 * span, at_drive=True),
            Parameter("spread", "", LIGHTEST, HEAVIEST, 1.0, 0.5),
        )
        if self.form == BANK:
            return own
        return (*own, Parameter("asymmetry", "", -0.9, 0.9, 0.0, 0.3))

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        share, state = slipped(signal, self.reaches(values), state)
        return signal - 0.5 * values[0] * weighted(share, self.asymmetry(values)), state

    def asymmetry(self, values: np.ndarray) -> float:
        return float(values[3]) if self.form == ASYMMETRIC else 0.0

    def reaches(self, values: np.ndarray) -> np.ndarray:
        """Of its stops, (ELEMENTS,) [drive unit], the shortest first."""
        return np.asarray(max(values[1], self.least_reach(values)) * stops_of(values[2]))

    def least_reach(self, values: np.ndarray) -> float:
        most = 0.5 * values[0] * (1.0 + abs(self.asymmetry(values)))
        return float(most * np.mean(1.0 / stops_of(values[2])))


def stops_of(spread: float) -> np.ndarray:
    """Reaches of the stops over their mean, (ELEMENTS,).

    spread = 0: all alike; 1: evenly from 0 on, so that a loop is two parabolas (Rayleigh); 2: as
    an exponential distribution, whose loop is Dahl's; from there on with a heavier tail. Those
    from 1 on are generalized Pareto distributions of the shape spread - 2.
    """
    if spread <= 1.0:
        return np.asarray(1.0 - spread + spread * _pareto(-1.0))
    return _pareto(spread - 2.0)


def _pareto(shape: float) -> np.ndarray:
    left = 1.0 - (np.arange(ELEMENTS) + 0.5) / ELEMENTS
    found = -np.log(left) if abs(shape) < 1e-9 else (left**-shape - 1.0) / shape
    return np.asarray(found / found.mean())

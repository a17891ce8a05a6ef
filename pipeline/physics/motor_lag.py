"""A motor of first order that is late itself, before gears and wires."""

import numpy as np

from pipeline.physics.held import followed, lag_parameter, usual_lags_s
from pipeline.physics.motion import Motion
from pipeline.physics.second_order_lag import SecondOrderLag
from pipeline.physics.slewing_motor import SlewingMotor
from pipeline.physics.term import Parameter, Surroundings, Term


class MotorLag(Term):
    """x' = (u - x) / tau before the nominal curve, for a command held through each dwell.

    Exact, however unevenly sampled. Source: first-order lag.
    """

    name = "response_lag"
    site = "body"
    form = "motor first"
    place = 0.0
    remembers = "time"
    group = "lag"
    timed = True
    before_curve = True
    unlikely = 3.0  # else chance would decide against old frames and play
    says = "The motor comes late, with a time constant of {time_constant}."

    @property
    def kin(self) -> str:
        return "first"

    def richer(self) -> tuple[Term, ...]:
        return SecondOrderLag("motor"), SlewingMotor()

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        return (lag_parameter(around),)

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        return followed(signal, motion, float(values[0]), np.inf, state)

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        return np.array(usual_lags_s(around))[:, None]

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        return around.drive_span > 0.0 and around.dwell_s > 0.0

"""Response lag: the body follows the command late as a whole."""

import numpy as np

from pipeline.physics.balance import Load
from pipeline.physics.motion import Motion
from pipeline.physics.term import Parameter, Surroundings, Term


class ResponseLag(Term):
    """x' = (u - x) / tau of a joint without other loads, for a command held through each dwell.

    A viscous drag in the balance (see `balance.py`): beside other loads the lag depends on them,
    longer where the wires hang slack, shorter against a stop. Source: first-order lag; Kelvin and
    Voigt's spring with a dashpot beside it.
    """

    name = "response_lag"
    site = "body"
    in_balance = True
    group = "lag"
    says = "The whole motion comes late, with a time constant of {time_constant}."

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        dwell = max(around.dwell_s, 1e-9)
        return (Parameter("time_constant", "s", 0.0, 30.0 * dwell, dwell, dwell),)

    def load(self, values: np.ndarray, motion: Motion) -> Load:
        return Load(drag=float(values[0]))

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        return max(around.dwell_s, 1e-9) * np.array([[0.3], [0.7], [1.5], [4.0]])

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        return around.drive_span > 0.0 and around.dwell_s > 0.0

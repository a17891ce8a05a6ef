"""Response lag: the body follows the command late as a whole."""

import numpy as np

from pipeline.physics.creep import dwells, lagged
from pipeline.physics.motion import Motion
from pipeline.physics.term import Parameter, Surroundings, Term


class ResponseLag(Term):
    """x' = (u - x) / tau, exact for a command that is held through each dwell.

    Source: first-order lag.
    """

    name = "response_lag"
    site = "body"
    group = "lag"
    says = "The whole motion comes late, with a time constant of {time_constant}."

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        dwell = max(around.dwell_s, 1e-9)
        return (Parameter("time_constant", "s", 0.0, 30.0 * dwell, dwell, dwell),)

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        if state is None:
            state = np.array([motion.time_s[0], signal[0]])
        dwell = dwells(motion, float(state[0]))
        decay = np.exp(-dwell / values[0]) if values[0] > 0.0 else np.zeros(len(dwell))
        out = lagged(signal, decay, float(state[1]))
        return out, np.array([motion.time_s[-1], out[-1]])

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        return max(around.dwell_s, 1e-9) * np.array([[0.3], [0.7], [1.5], [4.0]])

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        return around.drive_span > 0.0 and around.dwell_s > 0.0

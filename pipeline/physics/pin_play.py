"""Play in the joint itself: its pin has clearance in what it bears."""

import numpy as np

from pipeline.physics.motion import Motion
from pipeline.physics.play_operator import play
from pipeline.physics.term import Parameter, Surroundings, Term

PIN = "pin"


class PinPlay(Term):
    """x_k = max(theta_k - w/2, min(theta_k + w/2, x_{k-1})), w in the angle's unit.

    What the joint carries follows it through a gap, which is as wide wherever the joint is, however
    steep the nominal curve is there and whatever holds the joint. It starts in the middle of its
    gap. Source: the play operator, Krasnosel'skii and Pokrovskii, Systems with Hysteresis (1989),
    section 2.
    """

    name = "backlash"
    site = "transmission"
    form = PIN
    place = 85.0
    remembers = "way"
    group = "play"
    says = "What the joint carries turns through {width} of play after each reversal."

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        span = around.angle_span
        return (Parameter("width", around.angle_unit, 0.0, 0.9 * span, 0.05 * span, 0.05 * span),)

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        start = float(signal[0]) if state is None else float(state[0])
        out = play(signal, 0.5 * float(values[0]), start)
        return out, out[-1:].copy()

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        return around.angle_span * np.array([[0.003], [0.01], [0.03], [0.07], [0.15], [0.3]])

"""Play before what is simulated as a force and resists by its speed: idle in its gap."""

import numpy as np

from pipeline.physics.force_lost_way import ForceLostWay
from pipeline.physics.motion import Motion
from pipeline.physics.play_operator import play

IDLE = "force of an idle pin"


class ForceIdleWay(ForceLostWay):
    """F = R p'/x' + stiffness x, p the play operator of the position x, R = S - stiffness x.

    What resists of the simulated force S goes by the speed, and has none in the gap of a pin: as a
    piston in oil with play at its rod's end. `stiffness` is that of a simulated spring which no gap
    parts from the position. It begins in the middle of its gap. Source: play operator.
    """

    stays = "stands still, and does not resist, until that is crossed"

    def __init__(self, form: str = IDLE) -> None:
        self.form = form

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        x = np.ascontiguousarray(motion.drive)
        before, at = (x[0], x[0]) if state is None else state
        pushed = play(x, 0.5 * float(values[0]), float(at))
        moved = np.diff(x, prepend=before)
        share = np.divide(np.diff(pushed, prepend=at), moved, np.ones_like(x), where=moved != 0.0)
        spring = values[1] * x
        return spring + share * (signal - spring), np.array([x[-1], pushed[-1]])

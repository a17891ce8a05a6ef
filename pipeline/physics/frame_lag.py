"""Frame lag: the frame shows an earlier pose."""

import numpy as np

from pipeline.physics.motion import Motion
from pipeline.physics.term import Parameter, Surroundings, Term

KEPT = 12


class FrameLag(Term):
    """seen(t) = theta(t - lag), straight between samples; form "frames" counts the lag in samples.

    Source: pure delay of a buffered camera.
    """

    name = "frame_lag"
    site = "sensor"
    group = "lag"
    timed = True
    says = "The camera's frame is old: it shows the pose of {lag} before."

    def __init__(self, form: str = "time") -> None:
        self.form = form

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        if self.form == "frames":
            return (Parameter("lag", "frames", 0.0, KEPT - 2.0, 1.0, 1.0),)
        dwell = max(around.dwell_s, 1e-9)
        return (Parameter("lag", "s", 0.0, (KEPT - 2.0) * dwell, dwell, dwell),)

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        kept_time, kept = (NO_ROWS, NO_ROWS) if state is None else np.split(state, 2)
        time, poses = np.concatenate([kept_time, motion.time_s]), np.concatenate([kept, signal])
        at = np.arange(len(time), dtype=float) if self.form == "frames" else time
        seen = np.interp(at - values[0], at, poses)[len(kept) :]
        return seen, np.concatenate([time[-KEPT:], poses[-KEPT:]])

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        unit = 1.0 if self.form == "frames" else max(around.dwell_s, 1e-9)
        return unit * np.array([[0.3], [1.0], [2.0], [4.0]])

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        return around.drive_span > 0.0 and around.dwell_s > 0.0


NO_ROWS = np.zeros(0)

"""Tension loss: play that grows from cycle to cycle."""

import numpy as np
from numba import njit

from pipeline.physics.motion import Motion
from pipeline.physics.term import Parameter, Surroundings, Term

HOUR_S = 3600.0


@njit(cache=True)
def varying_play(drive: np.ndarray, half_width: np.ndarray, start: float) -> np.ndarray:
    """The play operator with a gap of its own for each sample."""
    out = np.empty(drive.size)
    at = start
    for i in range(drive.size):
        if drive[i] - half_width[i] > at:
            at = drive[i] - half_width[i]
        elif drive[i] + half_width[i] < at:
            at = drive[i] + half_width[i]
        out[i] = at
    return out


class TensionLoss(Term):
    """Play of width w0 + growth * s, where s is what wears the wire out.

    Form "travel": s is the travel of the drive (wear); "time": the time [h] since the first sample
    (relaxation); "cycle": the number of cycles. Source: the play operator with a width that changes.
    """

    name = "tension_loss"
    site = "transmission"
    before_curve = True
    group = "play"
    says = "The wire slackens: its play was {width} at the start and grows by {growth}."

    def __init__(self, form: str = "travel") -> None:
        self.form = form

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        span, unit = around.drive_span, around.drive_unit
        per = {"travel": f"{unit}/{unit}", "time": f"{unit}/h", "cycle": f"{unit}/cycle"}[self.form]
        most = span / self._whole(around)
        return (
            Parameter("growth", per, 0.0, most, 0.05 * most, 0.05 * most),
            Parameter("width", unit, 0.0, 0.8 * span, 0.02 * span, 0.05 * span),
        )

    def _whole(self, around: Surroundings) -> float:
        """What s comes to over the recording, roughly."""
        hours = (around.end_s - around.start_s) / HOUR_S
        cycles = max(around.cycles, 1)
        return {"travel": 2.0 * around.drive_span * cycles, "time": hours, "cycle": cycles}[
            self.form
        ]

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        if state is None:
            state = np.array([signal[0], signal[0], 0.0, motion.time_s[0], motion.cycle[0]])
        travel = state[2] + np.cumsum(np.abs(np.diff(signal, prepend=state[1])))
        worn = {
            "travel": travel,
            "time": (motion.time_s - state[3]) / HOUR_S,
            "cycle": motion.cycle - state[4],
        }[self.form]
        out = varying_play(signal, 0.5 * (values[1] + values[0] * worn), float(state[0]))
        return out, np.array([out[-1], signal[-1], travel[-1], state[3], state[4]])

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        growths = around.drive_span / self._whole(around) * np.array([0.01, 0.05, 0.2])
        widths = around.drive_span * np.array([0.0, 0.02, 0.06])
        return np.array([[g, w] for g in growths for w in widths])

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        return around.cycles >= 2 and around.drive_span > 0.0 and around.end_s > around.start_s

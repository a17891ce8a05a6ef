"""Frames that show a later pose than their time says: the clocks of command and sensor are off."""

import numpy as np

from pipeline.number_words import worded
from pipeline.physics.frame_lag import MOST_S, FrameLag
from pipeline.physics.held import STEP_AND_WAIT_S
from pipeline.physics.motion import Motion
from pipeline.physics.term import NO_STATE, Parameter, Surroundings

UNUSUAL = 8.0
OF_CYCLE = 0.02  # more would be another phase of what repeats
SHARES = (0.3, 1.0, 3.0)  # of the time from sample to sample


class EarlyFrames(FrameLag):
    """seen(t) = theta(t + lead), straight between samples, and on at its speed after the last one.

    As where commands are stamped after they were sent, or one machine's clock is behind. An answer
    that overshoots by its speed comes near it: theta + lead theta'. What follows a block of samples
    isn't known there: its last ones go on at their speed. Source: offset of two clocks, Paxson,
    SIGMETRICS (1998).
    """

    said_by_name = "time"
    unlikely = UNUSUAL
    beyond = "an answer that runs ahead of its command, as where two clocks are off"

    def __init__(self) -> None:
        super().__init__("ahead")

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        dwell_s, most_s = around.dwell_s, min(OF_CYCLE * around.period_s, MOST_S)
        return (Parameter("lead", "s", 0.0, max(most_s, dwell_s), dwell_s, dwell_s),)

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        time_s, asked_s = motion.time_s, motion.time_s + values[0]
        speed = (signal[-1] - signal[-2]) / (time_s[-1] - time_s[-2]) if len(time_s) > 1 else 0.0
        seen = np.interp(asked_s, time_s, signal)
        return seen + speed * np.maximum(asked_s - time_s[-1], 0.0), NO_STATE

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        return np.array(SHARES)[:, None] * around.dwell_s

    def sentence(self, values: np.ndarray, around: Surroundings) -> str:
        return f"The sensor runs {worded(values[0])} s ahead of the command."

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        return around.drive_span > 0.0 and 0.0 < around.dwell_s < STEP_AND_WAIT_S

"""Two clocks that run at different rates: what the sensor shows falls behind more and more."""

import numpy as np

from pipeline.number_words import worded
from pipeline.physics.frame_lag import NO_ROWS, FrameLag
from pipeline.physics.motion import Motion
from pipeline.physics.term import Parameter, Surroundings

FASTEST, UNUSUAL = 0.03, 8.0
SHIFTS = (0.01, 0.04, 0.15)  # at the end, of a cycle


class RunningClock(FrameLag):
    """seen(t) = theta(t - lag - rate (t - t_0)), straight between samples, t_0 the first time.

    As where one machine stamps the commands and another one the frames. Where the rate is negative
    the sensor runs ahead; after the last sample it all goes on at the speed that it had. Source:
    offset and skew of two clocks, Paxson, SIGMETRICS (1998).
    """

    said_by_name = "time"
    unlikely = UNUSUAL
    beyond = "two clocks that run at different rates"

    def __init__(self) -> None:
        super().__init__("clock")

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        (lag,) = FrameLag("time").parameters(around)
        typical = SHIFTS[1] / max(around.cycles, 1)
        return lag, Parameter("rate", "s/s", -FASTEST, FASTEST, 0.0, typical)

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        began_s = float(motion.time_s[0]) if state is None else float(state[0])
        kept_time, kept = (NO_ROWS, NO_ROWS) if state is None else np.split(state[1:], 2)
        time, poses = np.concatenate([kept_time, motion.time_s]), np.concatenate([kept, signal])
        late_s = values[0] + values[1] * (motion.time_s - began_s)
        asked_s = motion.time_s - late_s
        speed = (poses[-1] - poses[-2]) / (time[-1] - time[-2]) if len(time) > 1 else 0.0
        seen = np.interp(asked_s, time, poses) + speed * np.maximum(asked_s - time[-1], 0.0)
        first = max(int(np.searchsorted(time, time[-1] - max(late_s[-1], 0.0))) - 1, 0)
        return seen, np.concatenate([[began_s], time[first:], poses[first:]])

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        rates = np.array(SHIFTS) / max(around.cycles, 1)
        return np.array([[0.0, rate] for rate in (*rates, *-rates) if abs(rate) < FASTEST])

    def void(self, values: np.ndarray) -> bool:
        return bool(values[0] == 0.0 and values[1] == 0.0)

    def sentence(self, values: np.ndarray, around: Surroundings) -> str:
        lag, rate = worded(values[0]), worded(1e3 * abs(values[1]))
        way = "behind" if values[1] >= 0.0 else "ahead"
        return (
            f"Two clocks run at different rates: the sensor is {lag} s late at first, and gets "
            f"{rate} ms {way} each second."
        )

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        return around.drive_span > 0.0 and around.dwell_s > 0.0 and around.cycles > 1

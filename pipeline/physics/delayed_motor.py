"""A motor that hears of its command late, follows it late, and may have a top speed."""

import numpy as np

from pipeline.number_words import worded
from pipeline.physics.frame_lag import FrameLag
from pipeline.physics.held import STEP_AND_WAIT_S, lag_parameter, slewed, usual_lags_s
from pipeline.physics.limited_motor import LimitedMotor
from pipeline.physics.motion import Motion
from pipeline.physics.slewing_motor import (
    NO_FASTER,
    SPEEDS,
    SlewingMotor,
    fastest,
    speed_parameter,
)
from pipeline.physics.term import Parameter, Surroundings, Term

DELAYED, SLEWING = "delayed", "delayed slewing"
MOST_DWELLS, LATER = 20.0, (0.5, 1.5, 4.0)
FINELY = 8
LIMITED = " It rises at {top_speed} at most, and falls at {falling:.2g} times that."


class DelayedMotor(LimitedMotor):
    """x' = (u(t - dead_time) - x) / tau before gears and wires; in form SLEWING x' <= top_speed.

    There it falls `falling` times as fast at most: a load helps it one way, not the other.
    A bus and a controller that reckon once in a while come before the motor. The command runs
    straight from one sample to the next; what is heard of it in FINELY parts of each is held.
    Source: first-order lag with dead time (Ziegler and Nichols, Trans. ASME 64 (1942) 759).
    """

    far_apart = True
    says = (
        "The motor hears of its command {dead_time} late, and follows it with a time constant of "
        "{time_constant}."
    )

    def __init__(self, form: str = DELAYED) -> None:
        self.form = form
        self.slews = form == SLEWING
        self.beyond_lone = NO_FASTER if self.slews else ""

    @property
    def kin(self) -> str:
        return "first"

    def richer(self) -> tuple[Term, ...]:
        return () if self.slews else (DelayedMotor(SLEWING),)

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        dwell = max(around.dwell_s, 1e-9)
        dead = Parameter("dead_time", "s", 0.0, MOST_DWELLS * dwell, dwell, dwell)
        own = dead, lag_parameter(around)
        if not self.slews:
            return own
        return (*own, speed_parameter(around), Parameter("falling", "", 0.2, 5.0, 1.0, 0.2))

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        first = motion.time_s[:1], signal[:1]
        time_s, asked = first if state is None else np.split(state[1:], 2)
        time_s, asked = np.append(time_s, motion.time_s), np.append(asked, signal)
        begun = len(time_s) - len(signal)
        shares = np.arange(1, FINELY + 1) / FINELY
        dwell = np.diff(time_s[begun - 1 :])
        fine_s = (time_s[begun - 1 : -1, None] + dwell[:, None] * shares).ravel()
        heard = np.interp(fine_s - values[0], time_s, asked)
        top_speed, falling = map(float, values[2:]) if self.slews else (np.inf, 1.0)
        at = float(signal[0] if state is None else state[0])
        steps = np.repeat(dwell / FINELY, FINELY)
        out = slewed(heard, steps, float(values[1]), top_speed, at, falling)[FINELY - 1 :: FINELY]
        kept = max(int(np.searchsorted(time_s, time_s[-1] - values[0])) - 1, 0)
        return out, np.concatenate([out[-1:], time_s[kept:], asked[kept:]])

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        dead_s = max(around.dwell_s, 1e-9) * np.array(LATER)
        lags_s = usual_lags_s(around)[::2]
        if not self.slews:
            return np.array([[dead, lag] for dead in dead_s for lag in lags_s])
        speeds = fastest(around) * np.geomspace(2e-3, 0.25, SPEEDS)
        return np.array([[d, lag, v, 1.0] for d in dead_s for lag in lags_s[:2] for v in speeds])

    def other_names(self, values: np.ndarray, around: Surroundings) -> tuple[str, ...]:
        """What is heard late may as well be seen late."""
        return (FrameLag.name,)

    def sentence(self, values: np.ndarray, around: Surroundings) -> str:
        limit = ""
        if self.slews:
            top_speed = f"{worded(values[2])} {around.drive_unit}/s"
            limit = LIMITED.format(top_speed=top_speed, falling=values[3])
        return super().sentence(values, around) + limit

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        """Where a drive is sampled too often to step and wait."""
        often = around.dwell_s < STEP_AND_WAIT_S
        return often and SlewingMotor().excited(motion, around)

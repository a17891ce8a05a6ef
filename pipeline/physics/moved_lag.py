"""A lag of second order behind moves of a steady speed: a robot that moves, waits, and moves on."""

import numpy as np

from pipeline.physics.held import dwells, longest_lag_s, uneven, usual_lag_s
from pipeline.physics.motion import Motion
from pipeline.physics.second_order_lag import swung
from pipeline.physics.slewing_motor import fastest, speeds_of_steps
from pipeline.physics.term import Parameter, Surroundings, Term, Told

MOST_STEPS, QUICKER = 0.9, (1.0, 2.0, 5.0)
DAMPINGS = (0.5, 1.0, 3.0)


class MovedLag(Term):
    """x'' = w^2 (u - x) - 2 damping w x', u going at `speed` through each step, then held.

    w: `natural_frequency`. Where steps and waits differ, a small step waits longer than a large
    one, and no share of a dwell says how long its move took. Whatever loads the joint. Exact,
    however unevenly sampled. Source: linear system of second order; trapezoidal profile of a
    positioning drive, its ramps left out.
    """

    name = "response_lag"
    site = "body"
    form = "moved"
    place = 90.0
    remembers = "time"
    group = "lag"
    timed = True
    unlikely = 3.0  # else chance would decide against old frames
    says = (
        "The whole motion comes after moves of {speed}, with a natural frequency of "
        "{natural_frequency} and a damping of {damping}."
    )

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        low, high, most = (
            1.0 / longest_lag_s(around),
            30.0 / max(around.dwell_s, 1e-9),
            fastest(around),
        )
        unit = f"{around.drive_unit}/s"
        return (
            Parameter(
                "natural_frequency",
                "rad/s",
                low,
                high,
                1.0 / usual_lag_s(around),
                0.0,
                relative=True,
            ),
            Parameter("damping", "", 0.02, 5.0, 0.7, 0.5),
            Parameter("speed", unit, 1e-3 * most, most, 0.1 * most, 0.0, relative=True),
        )

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        if state is None:
            state = np.array([motion.time_s[0], signal[0], 0.0, signal[0], motion.drive[0]])
        dwell, asked = dwells(motion, float(state[0])), np.ascontiguousarray(signal)
        frequency, damping, speed = (float(value) for value in values)
        runs = np.abs(np.diff(motion.drive, prepend=state[4])) / speed
        out, last = swung(asked, dwell, runs, frequency, damping, float(state[3]), state[1:3])
        return out, np.concatenate([motion.time_s[-1:], last, motion.drive[-1:]])

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        units = max(around.dwell_s, 1e-9), usual_lag_s(around)
        paces = sorted({k / unit for k in (0.15, 0.5, 1.5, 6.0) for unit in units})
        return np.array([[p, d, s] for p in paces for d in DAMPINGS for s in usual_speeds(motion)])

    def scaled(self, values: np.ndarray, factor: float) -> np.ndarray:
        """As it is: it is as slow as its frequency is low."""
        return values.copy()

    def void(self, values: np.ndarray) -> bool:
        return False

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        """Where waits differ: else a share of each says it as well."""
        return around.drive_span > 0.0 and around.dwell_s > 0.0 and uneven(motion.time_s)


def usual_speeds(motion: Motion) -> list[float]:
    """Speeds at which nearly all steps of a motion fit into their time [drive unit/s]."""
    least = float(np.quantile(speeds_of_steps(motion), MOST_STEPS))
    return [max(quicker * least, 1e-12) for quicker in QUICKER]


def moved_as(lag_s: float, motion: Motion, around: Surroundings) -> list[Told]:
    """Such lags by which a slow motion is as late as by some other lag [s]."""
    term = MovedLag()
    if not term.excited(motion, around):
        return []
    low, high = ([getattr(p, end) for p in term.parameters(around)] for end in ("low", "high"))
    starts = [[2.0 * d / lag_s, d, speed] for d in DAMPINGS for speed in usual_speeds(motion)]
    return [[(term, start)] for start in np.clip(starts, low, high)]

"""Lag of second order: the body, or the motor before it, swings after the command."""

from collections.abc import Sequence

import numpy as np
from numba import njit

from pipeline.number_words import worded
from pipeline.physics.arms import NEARBY
from pipeline.physics.delayed_motor import SLEWING, DelayedMotor
from pipeline.physics.equilibrium import NEVER
from pipeline.physics.frame_lag import FrameLag
from pipeline.physics.held import dwells, longest_lag_s, usual_lag_s
from pipeline.physics.motion import Motion
from pipeline.physics.slewing_motor import speeds_of_steps
from pipeline.physics.tabled import inlined
from pipeline.physics.term import Parameter, Surroundings, Term, Told

NEARLY_CRITICAL = 1e-6
DEAD, SPEEDS = (0.3, 0.6), (0.15, 0.3, 0.6)


@inlined
def _left(t, decay, square, known):  # type: ignore[no-untyped-def]
    """What is left of a swing after a time t, and of its push.

    known: (3,) these two of a time nearby, behind it (in place). Dwells differ little: a series.
    """
    root, more = np.sqrt(abs(square)), t - known[0]
    if (decay + root) * abs(more) > NEARBY:
        known[0], more = t, 0.0
        fade = np.exp(-decay * t)
        if root * t < NEARLY_CRITICAL:
            known[1], known[2] = fade, fade * t
        elif square > 0.0:
            slow, fast = np.exp((root - decay) * t), np.exp(-(root + decay) * t)
            known[1], known[2] = 0.5 * (slow + fast), 0.5 * (slow - fast) / root
        else:
            known[1], known[2] = fade * np.cos(root * t), fade * np.sin(root * t) / root
    x, q = -decay * more, square * more * more
    fade = 1.0 + x * (1.0 + x / 2.0 * (1.0 + x / 3.0 * (1.0 + x / 4.0)))
    c, s = fade * (1.0 + q / 2.0 * (1.0 + q / 12.0)), fade * more * (1.0 + q / 6.0)
    return known[1] * c + square * known[2] * s, known[1] * s + known[2] * c


@njit(cache=True)
def swung(signal, dwell, runs, frequency, damping, before, state):  # type: ignore[no-untyped-def]
    """x'' + 2 z w x' + w^2 (x - u) = 0; the answer (n,) and the last (x, x').

    For `runs` (n,) of each dwell (n,) [s] the command u goes straight from the one before (`before`
    the first), then it is held. Exact: with r^2 = z^2 - 1 the error e = x - u, or x - u + 2 z / w
    u' while it runs, obeys e(t) = a(t) e0 + b(t) e0', a and b being exponentials times hyperbolic
    (r^2 > 0) or circular functions.
    """
    out = np.empty(signal.size)
    x, v = state[0], state[1]
    decay, square = damping * frequency, frequency * frequency * (damping * damping - 1.0)
    known = np.full((2, 3), -NEVER)
    for i in range(signal.size):
        moves = min(runs[i], dwell[i])
        for part in range(2):
            t = moves if part == 0 else dwell[i] - moves
            if t <= 0.0:
                continue
            speed = (signal[i] - before) / moves if part == 0 else 0.0
            trail = 2.0 * damping / frequency * speed
            e, u = x - (before if part == 0 else signal[i]) + trail, v - speed
            c, s = _left(t, decay, square, known[part])
            push = u + decay * e
            x = signal[i] - trail + c * e + s * push
            v = c * u - s * (decay * u + frequency * frequency * e) + speed
        before = signal[i]
        out[i] = x
    return out, np.array([x, v, before])


def swinging_as(lag_s: float) -> list[Told]:
    """Lags of second order by which a slow motion is as late as by some other lag [s]."""
    return [
        [(SecondOrderLag("second"), np.array([2.0 * damping / lag_s, damping, moving]))]
        for damping in (0.4, 0.6, 0.9)
        for moving in (0.0, 1.0)
    ]


class SecondOrderLag(Term):
    """x'' = w^2 (u - x) - 2 damping w x', w being `natural_frequency`; whatever loads the joint.

    Over the share `moving` of each dwell the command u runs to its next value. Form "second" is of
    what the joint does, after the balance; "motor" the same before gears and wires: as of a servo
    that is late itself. Exact, however unevenly sampled. Source: linear system of second order.
    """

    name = "response_lag"
    site = "body"
    remembers = "time"
    group = "lag"
    timed = True
    mistaken_for = FrameLag.name
    says = (
        "{who} swings after the command, with a natural frequency of {natural_frequency} and a "
        "damping of {damping}."
    )

    def __init__(self, form: str = "second") -> None:
        self.form = form
        self.before_curve = form == "motor"
        self.place = 0.0 if self.before_curve else 90.0

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        low, high = 1.0 / longest_lag_s(around), 6.0 / max(around.dwell_s, 1e-9)
        return (
            Parameter("natural_frequency", "rad/s", low, high, 1.0 / usual_lag_s(around), 0.0),
            Parameter("damping", "", 0.02, 5.0, 0.7, 0.5),
            Parameter("moving", "", 0.0, 1.0, 0.0, 0.5),
        )

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        if state is None:
            state = np.array([motion.time_s[0], signal[0], 0.0, signal[0]])
        dwell, asked = dwells(motion, float(state[0])), np.ascontiguousarray(signal)
        frequency, damping, moving = (float(value) for value in values)
        runs, before = moving * dwell, float(state[3])
        out, last = swung(asked, dwell, runs, frequency, damping, before, state[1:3])
        return out, np.concatenate([motion.time_s[-1:], last])

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        dwell, usual = max(around.dwell_s, 1e-9), usual_lag_s(around)
        paces = {k / unit for k in (0.15, 0.5, 1.5) for unit in (dwell, usual)}
        return np.array(
            [[p, damping, m] for p in sorted(paces) for damping in (0.2, 0.6, 1.2) for m in (0, 1)]
        )

    def instead(self, values: np.ndarray, motion: Motion, around: Surroundings) -> Sequence[Told]:
        """As much of dead time, lag and top speed: a servo at its limits seems to swing."""
        late_s, speed = 2.0 * values[1] / values[0], float(speeds_of_steps(motion).max())
        return [
            [(DelayedMotor(SLEWING), np.array([dead, late_s - dead, k * speed, 1.0]))]
            for dead in late_s * np.array(DEAD)
            for k in SPEEDS
        ]

    def scaled(self, values: np.ndarray, factor: float) -> np.ndarray:
        """As it is: a swing is as slow as its frequency is low."""
        return values.copy()

    def void(self, values: np.ndarray) -> bool:
        return False

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        return around.drive_span > 0.0 and around.dwell_s > 0.0

    def sentence(self, values: np.ndarray, around: Surroundings) -> str:
        return self.says.format(
            who="The motor itself" if self.form == "motor" else "The whole motion",
            natural_frequency=f"{worded(values[0])} rad/s",
            damping=f"{values[1]:.2g}",
        )

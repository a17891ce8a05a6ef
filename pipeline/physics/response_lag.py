"""Response lag: the body follows the command late as a whole."""

from typing import ClassVar

import numpy as np
from numba import njit

from pipeline.number_words import worded
from pipeline.physics.balance import Load
from pipeline.physics.equilibrium import NEARBY, NEVER
from pipeline.physics.frame_lag import FrameLag
from pipeline.physics.held import STEP_AND_WAIT_S, dwells, slewed, trailed
from pipeline.physics.motion import Motion
from pipeline.physics.tabled import inlined
from pipeline.physics.term import HELD, Parameter, Surroundings, Term, Told
from pipeline.physics.valved_lag import ValvedLag

NEARLY_CRITICAL = 1e-6
DENSE = 200
SPEEDS = 8
JUMP, RARE = 0.05, 0.2
FIRST_ORDER = ("first", "whole", "running")
MOTOR_FIRST = "motor first"
ONE_TIME = (*FIRST_ORDER, MOTOR_FIRST)


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
def swung(signal, dwell, frequency, damping, moving, before, state):  # type: ignore[no-untyped-def]
    """x'' + 2 z w x' + w^2 (x - u) = 0; the answer (n,) and the last (x, x').

    Over the first `moving` of each dwell (n,) [s] the command u runs straight from the one before
    (`before` the first), then it is held. Exact: with r^2 = z^2 - 1 the error e = x - u, or x - u +
    2 z / w u' while it runs, obeys e(t) = a(t) e0 + b(t) e0', a and b being exponentials times
    hyperbolic (r^2 > 0) or circular functions.
    """
    out = np.empty(signal.size)
    x, v = state[0], state[1]
    decay, square = damping * frequency, frequency * frequency * (damping * damping - 1.0)
    known = np.full((2, 3), -NEVER)
    for i in range(signal.size):
        runs = min(moving * dwell[i], dwell[i])
        for part in range(2):
            t = runs if part == 0 else dwell[i] - runs
            if t <= 0.0:
                continue
            speed = (signal[i] - before) / runs if part == 0 else 0.0
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
        [(ResponseLag("second"), np.array([2.0 * damping / lag_s, damping, moving]))]
        for damping in (0.4, 0.6, 0.9)
        for moving in (0.0, 1.0)
    ]


def usual_lag_s(around: Surroundings) -> float:
    """A lag that is usual: a dwell, or a small part of a cycle that is sampled densely [s]."""
    return max(around.dwell_s, around.period_s / DENSE, 1e-9)


class ResponseLag(Term):
    """x' = (u - x) / tau of a joint without other loads, for a command held through each dwell.

    A viscous drag in the balance (see `balance.py`): beside other loads the lag depends on them,
    longer where the wires hang slack, shorter against a stop. Form "whole" is the same after the
    balance: whatever loads the joint; "running" is that of a command that runs straight from one
    sample to the next. Form "second", after the balance:
    x'' = w^2 (u - x) - 2 damping w x', w being `natural_frequency`; over the share `moving` of each
    dwell the command runs to its next value. Form "motor" is the same of the motor, before gears
    and wires: as of a servo that is late itself; "motor first" is a motor of first order, "slewing"
    one that has a top speed (one that has that alone: `top_speed.py`). Exact, however unevenly
    sampled. Source: first-order lag; Kelvin and Voigt's spring with a dashpot beside it; linear
    system of second order; a rate limiter.
    """

    name = "response_lag"
    site = "body"
    remembers = "time"
    group = "lag"
    timed = True
    grows: ClassVar = {
        **dict.fromkeys(FIRST_ORDER, ("second", "motor", MOTOR_FIRST, "slewing")),
        MOTOR_FIRST: ("motor", "slewing"),
    }
    means = "the whole motion comes after the command"
    says = "The whole motion comes late, with a time constant of {time_constant}."
    says_of_second = (
        "{who} swings after the command, with a natural frequency of {natural_frequency} and a "
        "damping of {damping}."
    )
    says_of_slewing = (
        "The motor comes late, with a time constant of {time_constant}, and is never faster than "
        "{top_speed}."
    )

    def __init__(self, form: str = "first") -> None:
        self.form = form
        self.in_balance = form == "first"
        self.mistaken_for = FrameLag.name if form in ("second", "motor") else ""
        self.only_beside = HELD if form == "whole" else ""
        # else chance would decide against old frames and play
        self.unlikely = 3.0 if form in ("running", MOTOR_FIRST) else 0.0
        self.before_curve = form in ("motor", MOTOR_FIRST, "slewing")
        self.place = 0.0 if self.before_curve else 90.0

    @property
    def kin(self) -> str:
        return "first" if self.form in ONE_TIME else self.form

    def richer(self) -> tuple[Term, ...]:
        return (*super().richer(), *([ValvedLag()] if self.form in FIRST_ORDER else []))

    def elsewhere(self) -> tuple[Term, ...]:
        return (ResponseLag("whole"),) if self.form == "first" else ()

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        dwell = max(around.dwell_s, 1e-9)
        longest, usual = max(30.0 * dwell, 0.15 * around.period_s), usual_lag_s(around)
        late = Parameter("time_constant", "s", 0.0, longest, usual, usual)
        if self.form == "slewing":
            fastest = 2.0 * max(around.drive_span, 1e-12) / dwell
            low, unit = 1e-4 * fastest, f"{around.drive_unit}/s"
            return late, Parameter("top_speed", unit, low, fastest, 1e-2 * fastest, 0.0,
                                   relative=True)  # fmt: skip
        if self.form not in ONE_TIME:
            low, high = 1.0 / longest, 6.0 / dwell
            return (
                Parameter("natural_frequency", "rad/s", low, high, 1.0 / usual, 0.0),
                Parameter("damping", "", 0.02, 5.0, 0.7, 0.5),
                Parameter("moving", "", 0.0, 1.0, 0.0, 0.5),
            )
        return (late,)

    def load(self, values: np.ndarray, motion: Motion, state: np.ndarray | None) -> Load:
        return Load(drag=float(values[0]))

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        if state is None:
            state = np.array([motion.time_s[0], signal[0], 0.0, signal[0]])
        dwell, asked = dwells(motion, float(state[0])), np.ascontiguousarray(signal)
        if self.form == "running":
            before, at, late = float(state[3]), float(state[1]), float(values[0])
            out = trailed(asked, dwell, late, 1.0, before, at)
            return out, np.array([motion.time_s[-1], out[-1], 0.0, asked[-1]])
        if self.form in ("whole", MOTOR_FIRST, "slewing"):
            top_speed = float(values[1]) if self.form == "slewing" else np.inf
            out = slewed(asked, dwell, float(values[0]), top_speed, float(state[1]))
            return out, np.array([motion.time_s[-1], out[-1], 0.0, asked[-1]])
        frequency, damping, moving = (float(value) for value in values)
        out, last = swung(asked, dwell, frequency, damping, moving, float(state[3]), state[1:3])
        return out, np.concatenate([motion.time_s[-1:], last])

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        dwell, usual = max(around.dwell_s, 1e-9), usual_lag_s(around)
        lags = {k * unit for k in (0.3, 0.7, 1.5, 4.0) for unit in (dwell, usual)}
        if self.form == "slewing":
            fastest = 2.0 * around.drive_span / dwell
            speeds = fastest * np.geomspace(2e-3, 0.25, SPEEDS)
            return np.array([[lag, speed] for lag in sorted(lags)[::2] for speed in speeds])
        if self.form not in ONE_TIME:
            paces = {k / unit for k in (0.15, 0.5, 1.5) for unit in (dwell, usual)}
            return np.array(
                [
                    [p, damping, m]
                    for p in sorted(paces)
                    for damping in (0.2, 0.6, 1.2)
                    for m in (0.0, 1.0)
                ]
            )
        return np.array(sorted(lags))[:, None]

    def scaled(self, values: np.ndarray, factor: float) -> np.ndarray:
        """A lag of about `factor` times the size; a swing is as slow as its frequency is low."""
        if self.form not in ONE_TIME:
            return values.copy()
        return super().scaled(values, factor)

    def void(self, values: np.ndarray) -> bool:
        return self.form in ONE_TIME and super().void(values)

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        """Form "running" where a drive is sampled too often to step and wait, "slewing" there too.

        Elsewhere a top speed shows where the drive jumps, now and then.
        """
        moves = around.drive_span > 0.0 and around.dwell_s > 0.0
        if self.form == "running":
            return moves and around.dwell_s < STEP_AND_WAIT_S
        if self.form != "slewing":
            return moves
        jumps = float(np.mean(np.abs(np.diff(motion.drive)) > JUMP * around.drive_span))
        return moves and (0.0 < jumps < RARE or around.dwell_s < STEP_AND_WAIT_S)

    def sentence(self, values: np.ndarray, around: Surroundings) -> str:
        if self.form in ONE_TIME:
            return super().sentence(values, around)
        if self.form == "slewing":
            return self.says_of_slewing.format(
                time_constant=f"{worded(values[0])} s",
                top_speed=f"{worded(values[1])} {around.drive_unit}/s",
            )
        return self.says_of_second.format(
            who="The motor itself" if self.form == "motor" else "The whole motion",
            natural_frequency=f"{worded(values[0])} rad/s",
            damping=f"{values[1]:.2g}",
        )

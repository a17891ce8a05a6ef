"""Creep: part of the motion arrives late."""

from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from pipeline.physics.arriving_late import LARGEST, TIMES, ArrivingLate, share_and_time
from pipeline.physics.balance import Load
from pipeline.physics.held import STEP_AND_WAIT_S, dwells, trailed
from pipeline.physics.motion import Motion
from pipeline.physics.response_lag import ResponseLag
from pipeline.physics.rising_creep import RisingCreep
from pipeline.physics.term import HELD, Parameter, Surroundings, Term, Told

SPREAD, ARMS = "spread", 5
NARROW, BROADEST, BREADTHS, MOSTLY = 0.7, 1.5, (0.7, 1.1), 0.5
WHOLE = {"one": "whole", SPREAD: f"whole {SPREAD}"}


class Creep(ArrivingLate):
    """A spring with a dashpot beside the joint: it resists at first and gives way with time.

    In the balance, arm_j = s_j (theta - v_j), v_j' = (theta - v_j) / tau_j, with one or two arms.
    Of each motion of a free joint the `share` s / (1 + s) arrives late, with `time_constant` (1 +
    s) tau. Form "whole", after the balance: as much of each motion arrives late whatever loads the
    joint. There the command is held through each dwell; form "running" is "whole" for one that runs
    straight from sample to sample. Form "wire" creeps before the nominal curve, where over the
    share `moving` of each dwell the drive runs to its next value and what is late was `begun` ahead
    of the drive, as it was moved before; "wire two" has two arms. Forms "spread", "whole spread"
    and "wire spread" have ARMS equal ones whose time constants are evenly apart in their logarithm,
    over `breadth` decades to either side of `time_constant`: creep about as a power of time.
    Sources: standard linear solid (Zener); Findley, Lai and Onaran, Creep and Relaxation (1976),
    ch. 5.
    """

    grows: ClassVar = {
        "one": ("two", "wire", SPREAD, f"wire {SPREAD}"),
        "two": ("wire two",),
        "whole": ("wire", f"whole {SPREAD}", f"wire {SPREAD}"),
        "running": ("wire",),
        "wire": ("wire two", f"wire {SPREAD}"),
        SPREAD: (f"wire {SPREAD}",),
        f"whole {SPREAD}": (f"wire {SPREAD}",),
    }
    says = "Part of each motion ({share}) arrives late, with a time constant of {time_constant}."

    def __init__(self, form: str = "one") -> None:
        self.form = form
        self.before_curve = "wire" in form
        self.only_beside = HELD if form.startswith("whole") else ""
        self.unlikely = 3.0 if form == "running" else 0.0  # chance would decide against old frames
        self.in_balance = form in ("one", "two", SPREAD)

    @property
    def kin(self) -> str:
        return "one" if self.form in ("whole", "running") else self.form

    def richer(self) -> tuple[Term, ...]:
        plain = self.form in ("one", "whole", "running", "wire")
        return (*super().richer(), RisingCreep()) if plain else super().richer()

    def elsewhere(self) -> tuple[Term, ...]:
        return (Creep(WHOLE[self.form]),) if self.form in WHOLE else ()

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        share, late = share_and_time(around)
        own: tuple[Parameter, ...] = (share, late)
        if self.before_curve:
            span, unit = around.drive_span, around.drive_unit
            own = (
                *own,
                Parameter("moving", "", 0.0, 1.0, 0.0, 0.5),
                Parameter("begun", unit, -span, span, 0.0, 0.25 * span, weak=True),
            )
        if SPREAD in self.form:
            return (*own, Parameter("breadth", "", 0.0, BROADEST, 1.0, 0.5))
        if "two" not in self.form:
            return own
        return (
            *own,
            Parameter("share_2", "", 0.0, 0.8, 0.02, 0.1),
            Parameter("time_constant_2", "s", late.low, 3 * late.high, 16.0 * late.start, 0.0),
        )

    def load(self, values: np.ndarray, motion: Motion, state: np.ndarray | None) -> Load:
        share, time_constant = values[0::2], values[1::2]
        if SPREAD in self.form:
            late_s = spread_out(values)
            stiffness = np.full(ARMS, values[0] / (1.0 - values[0]) / ARMS)
            return Load(arm=np.column_stack([stiffness, late_s * (1.0 - values[0])]))
        arm = np.empty((len(share), 2))
        arm[:, 0] = share / (1.0 - share)
        arm[:, 1] = time_constant * (1.0 - share)
        return Load(arm=arm)

    def arms(self, values: np.ndarray) -> list[np.ndarray]:
        """Share and time constant of each arm, (2,)."""
        if SPREAD in self.form:
            return [np.array([values[0] / ARMS, late_s]) for late_s in spread_out(values)]
        return [values[:2], values[-2:]][: 2 if "two" in self.form else 1]

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        arms = self.arms(values)
        moving = float(values[2]) if self.before_curve else float(self.form == "running")
        if state is None:
            begun = signal[0] + (values[3] if self.before_curve else 0.0)
            state = np.array([motion.time_s[0], signal[0], *[begun] * len(arms)])
        dwell, asked = dwells(motion, float(state[0])), np.ascontiguousarray(signal)
        out, last = signal, [motion.time_s[-1], signal[-1]]
        for (share, late_s), at in zip(arms, state[2:], strict=True):
            late = trailed(asked, dwell, float(late_s), moving, float(state[1]), float(at))
            out = out + share * (late - signal)
            last.append(late[-1])
        return out, np.array(last)

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        dwell = max(around.dwell_s, 1e-9)
        rows = [[0.05, k * dwell] for k in TIMES]
        if self.before_curve:
            rows = [[*r, moving, 0.0] for moving in (0.0, 1.0) for r in rows]
        if "two" in self.form:
            rows = [[*r, 0.02, 12.0 * r[1]] for r in rows]
        if SPREAD in self.form:
            rows = [[*r, breadth] for breadth in BREADTHS for r in rows]
        return np.array(rows)

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        """Form "running" where a drive is sampled too often to step and wait."""
        runs = self.form != "running" or around.dwell_s < STEP_AND_WAIT_S
        return runs and super().excited(motion, around)

    def instead(self, values: np.ndarray, motion: Motion, around: Surroundings) -> Sequence[Told]:
        """A lag of the whole motion in place of an arm, where the share of that is the largest."""
        arms = [] if SPREAD in self.form else self.arms(values)
        return [
            [(ResponseLag(), arm[1:]), *((Creep(), other) for other in arms if other is not arm)]
            for arm in arms
            if arm[0] >= LARGEST
        ]

    def other_names(self, values: np.ndarray, around: Surroundings) -> tuple[str, ...]:
        """A motion that comes late for the most part lags: what it does at once may be its form."""
        share = max(arm[0] for arm in self.arms(values))
        return (ResponseLag.name,) if share > MOSTLY else ()

    def slight(self, values: np.ndarray, around: Surroundings) -> bool:
        """Arms slower than some cycles hardly answer them: their one settling is a drift.

        One of a spread's many may be; but a narrow spread is one time, or a lag beside friction.
        """
        if SPREAD in self.form and values[-1] < NARROW:
            return True
        last = {SPREAD: -2, "two": -1}.get(self.form.split(" ")[-1])
        return last is not None and bool(self.arms(values)[last][1] > SLOWEST * around.period_s)

    def retold(self, starts: np.ndarray) -> np.ndarray:
        """What one arm does in the middle, two do: one that is quicker, and one that is slower."""
        if "two" not in self.form:
            return starts
        share, time_constant = starts[0, :2]
        own = np.multiply([share, time_constant, share, time_constant], APART)
        if self.before_curve:
            own = np.insert(own, [2, 2], starts[0, 2:4], axis=1)
        return np.vstack([starts, own])


SLOWEST = 3.0
APART = (
    (0.5, 0.15, 0.9, 1.2),
    (0.9, 0.3, 0.5, 2.0),
    (0.5, 0.3, 0.9, 1.5),
    (0.2, 0.15, 0.9, 1.05),
)


def spread_out(values: np.ndarray) -> np.ndarray:
    """Time constants [s] of arms that are evenly apart in their logarithm, (ARMS,)."""
    middle_s, breadth = values[1], values[-1]
    return np.asarray(middle_s * 10.0 ** (breadth * np.linspace(-1.0, 1.0, ARMS)))

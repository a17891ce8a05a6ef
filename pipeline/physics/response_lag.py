"""Response lag: the body follows the command late as a whole."""

import numpy as np

from pipeline.physics.balance import Load
from pipeline.physics.delayed_motor import DelayedMotor
from pipeline.physics.held import (
    STEP_AND_WAIT_S,
    dwells,
    lag_parameter,
    slewed,
    trailed,
    usual_lags_s,
)
from pipeline.physics.motion import Motion
from pipeline.physics.motor_lag import MotorLag
from pipeline.physics.moved_lag import MovedLag
from pipeline.physics.second_order_lag import SecondOrderLag
from pipeline.physics.slewing_motor import SlewingMotor
from pipeline.physics.term import HELD, Parameter, Surroundings, Term
from pipeline.physics.valved_lag import ValvedLag

RUNNING, LOADED = "running", "running loaded"


class ResponseLag(Term):
    """x' = (u - x) / tau of a joint without other loads, for a command held through each dwell.

    A viscous drag in the balance (see `balance.py`): beside other loads the lag depends on them,
    longer where the wires hang slack, shorter against a stop. Form "whole" is the same after the
    balance: whatever loads the joint; "running" is that of a command that runs straight from one
    sample to the next, and "running loaded" the same in the balance. Exact, however unevenly
    sampled. Source: first-order lag; Kelvin and Voigt's spring with a dashpot beside it.
    """

    name = "response_lag"
    site = "body"
    place = 90.0
    remembers = "time"
    group = "lag"
    timed = True
    means = "the whole motion comes after the command"
    says = "The whole motion comes late, with a time constant of {time_constant}."

    def __init__(self, form: str = "first") -> None:
        self.form = form
        self.runs = form in (RUNNING, LOADED)
        self.in_balance = form in ("first", LOADED)
        self.only_beside = HELD if form in ("whole", LOADED) else ""
        # else chance would decide against old frames and play
        self.unlikely = 3.0 if self.runs else 0.0

    @property
    def kin(self) -> str:
        return "first"

    def richer(self) -> tuple[Term, ...]:
        swings = SecondOrderLag("second"), SecondOrderLag("motor")
        return (*swings, MovedLag(), MotorLag(), SlewingMotor(), ValvedLag(), DelayedMotor())

    def elsewhere(self) -> tuple[Term, ...]:
        other = {"first": "whole", RUNNING: LOADED}.get(self.form)
        return () if other is None else (ResponseLag(other),)

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        return (lag_parameter(around),)

    def load(self, values: np.ndarray, motion: Motion, state: np.ndarray | None) -> Load:
        return Load(drag=float(values[0]), runs=self.runs)

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        first = np.array([motion.time_s[0], signal[0], signal[0]])
        last_s, at, before = (float(value) for value in (first if state is None else state))
        dwell, asked = dwells(motion, last_s), np.ascontiguousarray(signal)
        late_s = float(values[0])
        if self.runs:
            out = trailed(asked, dwell, late_s, 1.0, before, at)
        else:
            out = slewed(asked, dwell, late_s, np.inf, at)
        return out, np.array([motion.time_s[-1], out[-1], asked[-1]])

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        return np.array(usual_lags_s(around))[:, None]

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        """Where it runs, of a drive that is sampled too often to step and wait."""
        often = around.dwell_s < STEP_AND_WAIT_S or not self.runs
        return around.drive_span > 0.0 and around.dwell_s > 0.0 and often

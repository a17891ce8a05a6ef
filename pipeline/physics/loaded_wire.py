"""Creep of a wire under all that it pulls against: friction, contact and weight as well."""

from dataclasses import replace

import numpy as np

from pipeline.physics.arriving_late import TIMES, ArrivingLate, share_and_time
from pipeline.physics.balance import Load
from pipeline.physics.creep import SLOWEST
from pipeline.physics.held import STEP_AND_WAIT_S
from pipeline.physics.motion import Motion
from pipeline.physics.term import Parameter, Surroundings, Term

CONVERSE, LEAST = 6.0, 5e-3
ALONE, TWO = "loaded wire", "loaded wire two"
AT_ONCE, AHEAD = 1.5, "an answer that runs ahead of its command, the faster the farther"
SHARE, STIFFNESSES, LATER = 0.07, (0.02, 0.1, 0.5), 8.0


class LoadedWire(ArrivingLate):
    """q (1 + share foreseen) = theta + f + x, x' = (share (theta + f / stiffness) - x) / tau.

    In the balance (`balance.py`): x is what the wire has stretched by in time under its pull,
    `stiffness` theta + f, where `stiffness` is the joint's own over the wire's and tau is
    `time_constant`. For long before the first sample the joint was `begun` farther than there. Of
    the joint's own pull alone that is the form "yielding wire", see there for `foreseen`. Beside
    friction the wire stretches by more, and the other way after each reversal. Form "loaded wire
    two" has two such stretches. Source: Kelvin and Voigt's element in series with a spring
    (standard linear solid), Findley, Lai and Onaran, Creep and Relaxation (1976), ch. 5.
    """

    in_balance = True
    says = (
        "Of each motion {share} is taken back, with a time constant of {time_constant}: the wire "
        "goes on stretching under all that it pulls against."
    )

    def __init__(self, form: str = ALONE) -> None:
        self.form = form
        self.unlikely = CONVERSE

    def richer(self) -> tuple[Term, ...]:
        return (LoadedWire(TWO),) if self.form == ALONE else ()

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        share, late = share_and_time(around)
        late, span = replace(late, low=around.dwell_s), around.angle_span
        own = (
            share,
            late,
            Parameter("stiffness", "", 2e-3, 10.0, 0.05, 0.0),
            Parameter("foreseen", "", 0.0, 1.0, 0.5, 0.5, weak=True),
            Parameter("begun", around.angle_unit, -span, span, 0.0, 0.25 * span, weak=True),
        )
        if self.form == ALONE:
            return own
        return (
            *own,
            Parameter("share_2", "", 0.0, 0.8, 0.02, 0.1),
            replace(late, name="time_constant_2", high=3.0 * late.high, start=LATER * late.start),
        )

    def load(self, values: np.ndarray, motion: Motion, state: np.ndarray | None) -> Load:
        stiffness, foreseen, begun = values[2:5]
        runs = motion.usual_dwell_s < STEP_AND_WAIT_S if state is None else state[0]
        stretches = [values[:2], values[-2:]][: 1 if self.form == ALONE else 2]
        rows = [[s, late_s, stiffness, runs, s * begun, s * foreseen] for s, late_s in stretches]
        wire = np.array(rows)
        known = np.zeros(0) if np.isnan(motion.usual_dwell_s) and state is None else wire[0, 3:4]
        return Load(wire=wire, carried=known)

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        dwell_s = max(around.dwell_s, 1e-9)
        rows = [[SHARE, k * dwell_s, own, 0.5, 0.0] for k in TIMES for own in STIFFNESSES]
        if self.form == TWO:
            rows = [[*r, 0.02, LATER * r[1]] for r in rows]
        return np.array(rows)

    def beyond_at(self, values: np.ndarray, around: Surroundings) -> str:
        return ahead(values, around)

    def slight(self, values: np.ndarray, around: Surroundings) -> bool:
        """Of two stretches one that is hardly any, or so slow that its one settling is a drift."""
        least = min(values[0], values[-2])
        return self.form == TWO and bool(least < LEAST or values[-1] > SLOWEST * around.period_s)


def ahead(values: np.ndarray, around: Surroundings) -> str:
    """That a wire which has stretched within a sample is none: a sum of a motion and its speed.

    values: share and time constant first.
    """
    at_once = values[1] < AT_ONCE * around.dwell_s
    return AHEAD if around.dwell_s < STEP_AND_WAIT_S and at_once else ""

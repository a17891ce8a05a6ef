"""Slips that come again: the shaft loses steps in every cycle at one end of its way."""

import numpy as np
from numba import njit

from pipeline.physics.lost_steps import LostSteps
from pipeline.physics.motion import Motion
from pipeline.physics.term import Parameter, Surroundings, Term

ONSETS = 12


@njit(cache=True)
def turns(drive, cycle, end, last, way, counted, count):  # type: ignore[no-untyped-def]
    """In how many cycles the drive has turned back at one end, (n,), way and cycle of the last.

    end: 1 for tops, -1 for bottoms. last, way, counted, count: drive, way, the last cycle that
    counted and how many did, before.
    """
    out = np.empty(drive.size)
    for i in range(drive.size):
        moved = end * (drive[i] - last)
        last = drive[i]
        if moved != 0.0:
            if way > 0.0 and moved < 0.0 and cycle[i] > counted:
                counted = cycle[i]
                count += 1.0
            way = moved
        out[i] = count
    return out, way, counted


class RecurringSlip(Term):
    """x(t) = u(t) + jump n(t), n being cycles that turned at one end since a time [drive unit].

    A motor that is too weak where its load is greatest loses steps there in each cycle, and its
    zero goes down stairs. Forms "every top" and "every bottom". Source: definition.
    """

    name = LostSteps.name
    site = LostSteps.site
    place = LostSteps().place
    before_curve = True
    slow = True
    unlikely = LostSteps.unlikely
    says = "The shaft slips by {jump} in every cycle as it turns, from {time} on."

    def __init__(self, form: str = "every top") -> None:
        self.form = form
        self.end = 1.0 if form == "every top" else -1.0

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        once, start = 0.01 * around.drive_span, around.start_s
        most = around.drive_span / max(around.cycles, 1)
        return (
            Parameter("jump", around.drive_unit, -most, most, once, once),
            Parameter("time", "s", start, around.end_s, start, 0.0, True),
        )

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        jump, since_s = values
        first = (motion.drive[0], 0.0, motion.cycle[0] - 1.0, 0.0, 0.0)
        last, way, cycle, count, before = first if state is None else state
        turned, way, cycle = turns(
            motion.drive, motion.cycle.astype(float), self.end, last, way, cycle, count
        )
        since = int(np.searchsorted(motion.time_s, since_s))
        before = turned[since - 1] if since > 0 else before
        slips = np.maximum(turned - before, 0.0)
        return signal + jump * slips, np.array([motion.drive[-1], way, cycle, turned[-1], before])

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        starts = motion.cycle_begins[:-1]
        few = starts[np.unique(np.linspace(0, len(starts) - 1, ONSETS).astype(int))]
        size = 0.003 * around.drive_span
        return np.column_stack([np.full(len(few), size), motion.time_s[few]])

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        return around.cycles >= 2

    def sentence(self, values: np.ndarray, around: Surroundings) -> str:
        end = "upper" if self.end > 0 else "lower"
        return super().sentence(values, around).replace("turns,", f"turns at its {end} end,")

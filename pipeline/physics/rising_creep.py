"""Creep that grows faster than the pull: nonlinear viscoelasticity."""

from collections.abc import Sequence

import numpy as np

from pipeline.physics.arriving_late import LARGEST, TIMES, ArrivingLate, share_and_time
from pipeline.physics.held import dwells, trailed
from pipeline.physics.motion import Motion
from pipeline.physics.second_order_lag import SecondOrderLag
from pipeline.physics.term import Parameter, Surroundings, Term, Told

RISING = "rising"


class RisingCreep(ArrivingLate):
    """x = u - (g - late), g = (share + rise |u|) u, late' = (g - late) / time_constant.

    Of a wire that is pulled the more a larger share of the motion arrives late; its pull goes with
    the drive from home. Where `rise` is 0 it is linear creep before the nominal curve, of which
    `moving` and `begun` are told there. Source: Schapery, Polymer Engineering and Science 9 (1969)
    295, the stress under the integral times a factor that grows with it, to its first power.
    """

    form = RISING
    before_curve = True
    says = (
        "Part of each motion, the more the farther it is from home, arrives late, with a time "
        "constant of {time_constant}."
    )

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        unit, span = around.drive_unit, around.drive_span
        half = 0.5 * span
        return (
            *share_and_time(around),
            Parameter("moving", "", 0.0, 1.0, 0.0, 0.5),
            Parameter("begun", unit, -span, span, 0.0, 0.25 * span, weak=True),
            Parameter("rise", f"1/{unit}", 0.0, LARGEST / half, 0.1 / half, 0.1 / half),
        )

    def scaled(self, values: np.ndarray, factor: float) -> np.ndarray:
        return values * np.array([factor, 1.0, 1.0, 1.0, factor])

    def void(self, values: np.ndarray) -> bool:
        return bool(values[0] == 0.0 and values[-1] == 0.0)

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        share, late_s, moving, begun, rise = (float(v) for v in values)
        if state is None:
            at = signal[0] + begun
            state = np.array([motion.time_s[0], signal[0], (share + rise * abs(at)) * at])
        pulled, before = (share + rise * np.abs(signal)) * signal, float(state[1])
        before *= share + rise * abs(before)
        dwell = dwells(motion, float(state[0]))
        late = trailed(pulled, dwell, late_s, moving, before, float(state[2]))
        return signal - pulled + late, np.array([motion.time_s[-1], signal[-1], late[-1]])

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        dwell, rise = max(around.dwell_s, 1e-9), 0.1 / max(around.drive_span, 1e-300)
        return np.array([[0.0, k * dwell, 0.0, 0.0, rise] for k in TIMES])

    def instead(self, values: np.ndarray, motion: Motion, around: Surroundings) -> Sequence[Told]:
        """A motor that is late: beside slack or a stop it looks so, and no plain lag is near it."""
        late = SecondOrderLag("motor")
        return [[(late, start)] for start in late.candidates(motion, around)]


def rising_as(loop: float, around: Surroundings) -> list[tuple[Term, np.ndarray]]:
    """Such creep of several time constants with about as wide a loop half way out [drive unit]."""
    if around.dwell_s <= 0.0 or around.travel <= 0.0:
        return []
    out, speed = 0.25 * around.drive_span, around.travel / (around.end_s - around.start_s)
    late = [k * around.dwell_s for k in TIMES]
    rises = [loop / (4.0 * out * min(late_s * speed, 0.5 * out)) for late_s in late]
    starts = [[0.0, s, 0.0, 0.0, rise] for s, rise in zip(late, rises, strict=True)]
    return [(RisingCreep(), np.array(start)) for start in starts]

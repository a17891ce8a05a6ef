"""Play whose flanks give: what they push comes after, sooner than the next sample but one."""

import numpy as np
from numba import njit

from pipeline.physics.held import STEP_AND_WAIT_S, dwells
from pipeline.physics.motion import Motion
from pipeline.physics.term import Parameter, Surroundings, Term

PARTS, SLOWEST = 4, 0.5
SHARES = (0.1, 0.25)


@njit(cache=True)
def yielded(drive, dwell, half_width, settling, before, at):  # type: ignore[no-untyped-def]
    """Where the load is, (n,), of a drive that runs straight between samples, in PARTS parts.

    before, at: where the drive and the load were ahead of the first sample.
    """
    out = np.empty(drive.size)
    for i in range(drive.size):
        left = np.exp(-dwell[i] / (PARTS * settling)) if settling > 0.0 else 0.0
        for k in range(PARTS):
            ahead = before + (drive[i] - before) * (k + 1) / PARTS - at
            if ahead > half_width:
                at += (1.0 - left) * (ahead - half_width)
            elif ahead < -half_width:
                at += (1.0 - left) * (ahead + half_width)
        before = drive[i]
        out[i] = at
    return out


class YieldingPlay(Term):
    """settling x' = the drive u less the load x beyond the half gap w/2, and 0 within it.

    Play as `backlash.py` has it pushes with rigid flanks. Teeth, pins and wires give a little, and
    the load, held by friction of its own, comes after: within half of the time from sample to
    sample at most, else it is a lag of the joint. It starts in the middle of its gap.
    Source: Nordin and Gutman, Automatica 38 (2002) 1633 (a shaft that gives behind a dead zone,
    its load overdamped).
    """

    name = "backlash"
    site = "transmission"
    place = 30.0
    remembers = "way"
    before_curve = True
    timed = True
    group = "play"
    form = "yielding"
    says = (
        "The drive turns through {width} of play after each reversal before its flanks push; these "
        "give, and the load follows within {settling}."
    )

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        span, unit = around.drive_span, around.drive_unit
        most = SLOWEST * max(around.dwell_s, 1e-9)
        return (
            Parameter("width", unit, 0.0, 0.9 * span, 0.05 * span, 0.05 * span),
            Parameter("settling", "s", 0.0, most, 0.5 * most, 0.0),
        )

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        asked = np.ascontiguousarray(signal)
        last_s, before, at = (motion.time_s[0], asked[0], asked[0]) if state is None else state
        dwell = dwells(motion, float(last_s))
        width, settling = (float(v) for v in values)
        out = yielded(asked, dwell, 0.5 * width, settling, float(before), float(at))
        return out, np.array([motion.time_s[-1], asked[-1], out[-1]])

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        widths = around.drive_span * np.array([0.003, 0.01, 0.03, 0.1])
        return np.array([[w, s * around.dwell_s] for w in widths for s in SHARES])

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        """Where a drive is sampled as it moves: what steps and waits has pushed long before."""
        return around.drive_span > 0.0 and 0.0 < around.dwell_s < STEP_AND_WAIT_S

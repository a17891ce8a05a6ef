"""Play whose flanks give: what they push comes a little after."""

import numpy as np
from numba import njit

from pipeline.physics.drive_play import DrivePlay
from pipeline.physics.held import STEP_AND_WAIT_S, dwells
from pipeline.physics.motion import Motion
from pipeline.physics.term import Parameter, Surroundings

SLOWEST, LONGEST = 0.5, 0.005  # of the time from sample to sample, and of a cycle
SETTLE = (0.1, 0.25)
FOLLOWING = "following"


@njit(cache=True, error_model="numpy")
def yielded(drive, dwell, half_width, settling, before, at):  # type: ignore[no-untyped-def]
    """Where the load is, (n,), of a drive that runs straight between samples; exact.

    A flank that pushes is pressed in by b, b' = v - b / settling at the speed v of the drive
    against it, until that is 0; then the drive crosses the gap. before, at: where the drive and the
    load were ahead of the first sample.
    """
    out = np.empty(drive.size)
    for i in range(drive.size):
        left, asked = dwell[i], before
        speed = (drive[i] - before) / left if left > 0.0 else 0.0
        way = 1.0 if asked > at else -1.0
        pressed = way * (asked - at) - half_width
        if pressed < 0.0:
            way = 0.0
        while left > 0.0:
            if way == 0.0:
                if speed == 0.0:
                    break
                way = 1.0 if speed > 0.0 else -1.0
                spent = min(max(half_width - way * (asked - at), 0.0) / abs(speed), left)
                pressed = 0.0
            else:
                spent, trail = left, way * speed * settling
                leaves = way * speed < 0.0
                if leaves:
                    lasts = settling * np.log1p(pressed / -trail) if settling > 0.0 else 0.0
                    leaves = lasts < left
                    spent = min(lasts, left)
                fade = np.exp(-spent / settling) if settling > 0.0 else 0.0
                pressed = 0.0 if leaves else trail + (pressed - trail) * fade
                at = asked + speed * spent - way * (half_width + pressed)
                way = 0.0 if leaves else way
            asked += speed * spent
            left -= spent
        before = drive[i]
        out[i] = at
    return out


class YieldingPlay(DrivePlay):
    """settling x' = the drive u less the load x beyond the half gap w/2, and 0 within it.

    Play as `backlash.py` has it pushes with rigid flanks. Teeth, pins and wires give a little, and
    the load, held by friction of its own, comes after: within half of the time from sample to
    sample at most, else it is a lag of the joint; in form "following", that stands in the place of
    a small lag, within half a per cent of a cycle. What gives by more than the drive turns through
    to reach it is no flank: then it is the whole that comes late. It starts in the middle of its
    gap.
    Source: Nordin and Gutman, Automatica 38 (2002) 1633 (a shaft that gives behind a dead zone,
    its load overdamped).
    """

    timed = True
    says = (
        "The drive turns through {width} of play after each reversal before its flanks push; these "
        "give, and the load follows within {settling}."
    )

    def __init__(self, form: str = "yielding") -> None:
        self.form = form

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        most = SLOWEST * max(around.dwell_s, 1e-9)
        if self.form == FOLLOWING:
            most = max(most, LONGEST * around.period_s)
        return (
            self.width(around),
            Parameter("settling", "s", 0.0, most, 0.5 * most, 0.0),
        )

    def slight(self, values: np.ndarray, around: Surroundings) -> bool:
        usual_speed = around.step / max(around.dwell_s, 1e-9)
        return self.form != FOLLOWING and values[1] * usual_speed > 0.5 * values[0]

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
        given = self.widths(around)
        return np.array([[w, s * around.dwell_s] for w in given for s in SETTLE])

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        """Where a drive is sampled as it moves: what steps and waits has pushed long before."""
        return around.drive_span > 0.0 and 0.0 < around.dwell_s < STEP_AND_WAIT_S

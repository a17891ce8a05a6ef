"""Play before a load that has mass: in the gap it runs on by itself."""

from typing import ClassVar

import numpy as np
from numba import njit

from pipeline.physics.drive_play import DrivePlay
from pipeline.physics.driven_through_spring import thrown
from pipeline.physics.held import dwells
from pipeline.physics.motion import Motion
from pipeline.physics.term import Parameter, Surroundings

PARTS = 4
MET = 1.0 - np.exp(-1.0 / PARTS)
SLOWEST, FASTEST = 1e-3, 1e3
COASTS_S, SOON = 0.05, 0.1
UNUSUAL = 12.0  # a servo comes late hundreds of times more often than its load coasts so far
ELASTIC = "elastic"
SOFTEST, DAMPING = 0.5, 0.2
FREQUENCIES = SOFTEST * 2.0 ** np.arange(4)


@njit(cache=True)
def coasted(drive, dwell, half_width, drag, fading, state):  # type: ignore[no-untyped-def]
    """Where the load is, (n,), and where the drive, load and the load's speed are at last, (3,).

    Between two samples the drive runs straight, in PARTS parts. An end of the gap that pushes
    brings the load to the drive's speed over about one sample.
    """
    out = np.empty(drive.size)
    before, at, speed = state
    for i in range(drive.size):
        part = dwell[i] / PARTS
        if part > 0.0:
            pace = (drive[i] - before) / dwell[i]
            kept, slowed = np.exp(-fading * part), drag * part
            for k in range(PARTS):
                now = before + (drive[i] - before) * (k + 1) / PARTS
                speed = np.sign(speed) * max(kept * abs(speed) - slowed, 0.0)
                at += speed * part
                if at < now - half_width:
                    at = now - half_width
                    speed += MET * max(pace - speed, 0.0)
                elif at > now + half_width:
                    at = now + half_width
                    speed += MET * min(pace - speed, 0.0)
        before = drive[i]
        out[i] = at
    return out, np.array([before, at, speed])


class CoastingPlay(DrivePlay):
    """q'' = -drag sgn(q') - fading q' in a gap w about the drive u, |q - u| <= w/2.

    Play as `backlash.py` has it stops the load wherever nothing pushes it. A load with mass runs on
    at the speed that it had until dry friction (`drag`, over the mass) and viscous friction
    (`fading`) have stopped it, or the other end of the gap, which does not throw it back. It starts
    at rest in the middle of its gap. In form "elastic" no rigid end of the gap drives it, but teeth
    and a shaft that give (see `thrown`), no softer than lets the load follow within a few samples:
    softer ones make the whole motion late, which is a lag. Source: Nordin and Gutman, Automatica 38
    (2002) 1633 (backlash between two masses).
    """

    timed = True
    far_apart = True
    unlikely = UNUSUAL
    form = "coasting"
    grows: ClassVar = {"coasting": (ELASTIC,)}
    says = (
        "The drive turns through {width} of play, in which the load runs on, slowed by {drag} of "
        "dry friction over its mass."
    )

    def __init__(self, form: str = "") -> None:
        super().__init__(form)
        self.own_law = self.form == ELASTIC

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        unit = around.drive_unit
        drag, pace = usual_drag(around), usual_pace(around)
        own = (
            self.width(around),
            Parameter("drag", f"{unit}/s^2", SLOWEST * drag, FASTEST * drag, drag, 0.0,
                      relative=True),
            Parameter("fading", "1/s", 0.0, 1.0 / max(around.dwell_s, 1e-9), pace, 3.0 * pace),
        )  # fmt: skip
        if self.form != ELASTIC:
            return own
        most = 6.0 / max(around.dwell_s, 1e-9)
        softest = SOFTEST / max(around.dwell_s, 1e-9)
        return (
            *own,
            Parameter("natural_frequency", "rad/s", softest, most, 2.0 * softest, 0.0,
                      relative=True),
            Parameter("damping", "", 0.0, 3.0, DAMPING, 0.5),
        )  # fmt: skip

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        asked = np.ascontiguousarray(signal)
        if state is None:
            state = np.array([motion.time_s[0], asked[0], asked[0], 0.0])
        dwell = dwells(motion, float(state[0]))
        if self.form == ELASTIC:
            out, last = thrown(asked, dwell, values, state[1:])
        else:
            width, drag, fading = (float(v) for v in values)
            out, last = coasted(asked, dwell, 0.5 * width, drag, fading, state[1:])
        return out, np.concatenate([motion.time_s[-1:], last])

    def other_names(self, values: np.ndarray, around: Surroundings) -> tuple[str, ...]:
        """None: what runs on by itself in its gap, no wire pulls there."""
        return ()

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        widths = self.widths(around)
        drags = usual_drag(around) * np.array([0.1, 1.0, 10.0])
        paces = usual_pace(around) * np.array([0.3, 3.0])
        if self.form == ELASTIC:
            swings = FREQUENCIES / max(around.dwell_s, 1e-9)
            return np.array(
                [[w, drags[1], paces[0], s, DAMPING] for w in widths[1:] for s in swings]
            )
        slowed = [(drag, fading) for drag in drags for fading in paces]
        slowed.append((drags[0], SOON / max(around.dwell_s, 1e-9)))
        return np.array([[w, *how] for w in widths for how in slowed])

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        """Where a drive is sampled often enough to see a load coast, some tenths of a second."""
        return around.drive_span > 0.0 and 0.0 < around.dwell_s < COASTS_S


def usual_pace(around: Surroundings) -> float:
    """Radians of a cycle in a second [1/s]."""
    return 2.0 * np.pi / max(around.period_s, 1e-9)


def usual_drag(around: Surroundings) -> float:
    """The most that a sine over the drive's range accelerates, once a cycle [drive unit/s^2]."""
    return 0.5 * around.drive_span * usual_pace(around) ** 2

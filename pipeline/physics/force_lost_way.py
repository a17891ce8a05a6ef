"""Play before what is simulated as a force: a pin that pushes it only after its gap."""

import numpy as np
from numba import njit

from pipeline.number_words import worded
from pipeline.physics.force_slack import WIDTHS
from pipeline.physics.force_term import per
from pipeline.physics.motion import Motion
from pipeline.physics.term import Parameter, Surroundings, Term

HELD, FREE = "force of a pin", "force of a free pin"
WIDEST, STIFFEST = 0.5, 4.0
CARRIED = 8


class ForceLostWay(Term):
    """F = R(t') + stiffness * x, R = S - stiffness * x being what resists of the simulated force S.

    That hangs on a pin in a gap of `width`; `stiffness` is that of a simulated spring which no gap
    parts from the position. Where the pin pushes, it does what the simulation did so much way
    earlier in the same stroke, at t'. In the gap it stays, and resists, as it was pushed last. Form
    "force of a free pin": first it springs back to where it does not resist any more; that is how
    it is in the gap. It begins pushed. Source: play operator; what resists goes by the way since
    its reversal (Masing, 1926).
    """

    name = "backlash"
    site = "transmission"
    place = 100.0
    remembers = "way"
    unlikely = 2.0
    says = "What is simulated hangs on a pin in a gap of {width}: after each reversal it "

    @property
    def stays(self) -> str:
        """What it does in the gap."""
        return "does not resist in there" if self.form == FREE else "stays, until that is crossed"

    def __init__(self, form: str = HELD) -> None:
        self.form = form

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        span = max(around.drive_span, 1e-12)
        most = STIFFEST * around.angle_span / span
        return (
            Parameter("width", around.drive_unit, 0.0, WIDEST * span, 0.05 * span, 0.05 * span),
            Parameter("stiffness", per(around, 0), 0.0, most, 0.0, 0.2 * most),
        )

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        width, stiffness = float(values[0]), float(values[1])
        x, resists, kept = motion.drive, signal - stiffness * motion.drive, 0
        begun = np.zeros(CARRIED)
        if state is not None:
            begun, (ways, forces) = state[:CARRIED].copy(), np.split(state[CARRIED:], 2)
            x, resists, kept = (*map(np.concatenate, ((ways, x), (forces, resists))), len(ways))
        behind = _free if self.form == FREE else _held
        out = behind(np.ascontiguousarray(x), resists, width, kept, begun)[kept:]
        first = int(min(begun[1], begun[2]))
        begun[1:3] -= first
        return out + stiffness * motion.drive, np.concatenate([begun, x[first:], resists[first:]])

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        """With all that the simulation has of a spring pushed at once, and with none."""
        assert motion.kinetics is not None
        slope = float(np.polyfit(motion.drive, motion.kinetics.simulated, 1)[0])
        stiff = float(np.clip(slope, 0.0, self.parameters(around)[1].high))
        widths = around.drive_span * np.array((0.3 * WIDTHS[0], *WIDTHS))
        return np.array([[width, own] for width in widths for own in (0.0, stiff)])

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        """Where something is simulated that resists."""
        return motion.kinetics is not None and around.resisting and around.drive_span > 0.0

    def sentence(self, values: np.ndarray, around: Surroundings) -> str:
        told = f"{super().sentence(values, around)}{self.stays}."
        if values[1] == 0.0:
            return told
        return f"{told} A spring of {worded(values[1])} {per(around, 0)} is pushed at once."


@njit(cache=True, error_model="numpy")
def _then(x, resists, at, last, wanted, way):  # type: ignore[no-untyped-def]
    """What resists when the position first was as wanted, looked for from `at`; and where it was.

    way: in which the position goes; before `at` it has not been there.
    """
    while at + 1 <= last and way * (x[at + 1] - wanted) <= 0.0:
        at += 1
    if at == last or way * (x[at] - wanted) > 0.0:
        return resists[at], at
    share = (wanted - x[at]) / (x[at + 1] - x[at])
    return resists[at] + share * (resists[at + 1] - resists[at]), at


@njit(cache=True, error_model="numpy")
def _held(x, resists, width, kept, begun):  # type: ignore[no-untyped-def]
    """What resists behind a gap in which it stays as it was pushed, (n,).

    begun, in place: the way that it was pushed last, the sample after which the simulation was
    there, where the position was farthest that way, and what resisted.
    """
    out = np.empty(x.size)
    way, at, turn, here = begun[0], int(begun[1]), int(begun[2]), begun[3]
    for i in range(kept, x.size):
        if i == 0:
            here = resists[0]
        if way * (x[i] - x[turn]) > 0.0:
            turn = i
        if x[i] != x[turn] and (way == 0.0 or way * (x[turn] - x[i]) > width):
            way, at, turn = (1.0 if x[i] > x[turn] else -1.0), turn, i
        wanted = x[i] - way * width
        if way * (x[at] - wanted) <= 0.0:
            here, at = _then(x, resists, at, i, wanted, way)
        out[i] = here
    begun[0], begun[1], begun[2], begun[3] = way, at, turn, here
    return out


@njit(cache=True, error_model="numpy")
def _free(x, resists, width, kept, begun):  # type: ignore[no-untyped-def]
    """What resists behind a gap in which it does not, (n,).

    begun, in place: the way that the position goes, the sample after which the simulation was as it
    is now, where that way began, the side on which it is pushed, whether it is free, how far from
    that side then, how much of the way it was free, and what resisted last.
    """
    out = np.empty(x.size)
    way, at, turn, side, free, apart, spent, last = begun
    at, turn = int(at), int(turn)
    for i in range(kept, x.size):
        moved = x[i] - x[i - 1] if i > 0 else 0.0
        if moved != 0.0 and way * moved <= 0.0:
            way, at, turn, spent = (1.0 if moved > 0.0 else -1.0), i - 1, i - 1, 0.0
            side = side if side != 0.0 else way
        if free > 0.0:
            apart -= side * moved
            beyond = max(-apart, apart - width)
            spent += abs(moved) - max(beyond, 0.0)
            if beyond >= 0.0:
                side, free = (-side if apart > 0.0 else side), 0.0
        if free == 0.0:
            wanted, before = x[i] - way * spent, last
            last, at = _then(x, resists, at, i, wanted, way)
            if side * last < 0.0:
                apart = (
                    abs(moved) * min(last / (last - before), 1.0) if side * before > 0.0 else 0.0
                )
                side, free = (-side, 0.0) if apart >= width else (side, 1.0)
                spent += min(apart, width)
                at = turn
                last, at = _then(x, resists, at, i, x[i] - way * spent, way)
        if free > 0.0:
            last = 0.0
        out[i] = last
    begun[:] = np.array([way, at, turn, side, free, apart, spent, last])
    return out

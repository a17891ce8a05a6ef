"""A joint that snaps from one rest to another, at one place on the way up, at a lower one down."""

from typing import ClassVar

import numpy as np

from pipeline.number_words import worded
from pipeline.physics.friction import Friction
from pipeline.physics.motion import Motion
from pipeline.physics.play_operator import varying_play
from pipeline.physics.term import Parameter, Surroundings, Term

UNUSUAL, BENT, CURVED = 6.0, "snapping bent", "snapping curved"
MIDDLES, APARTS = (0.2, 0.35, 0.5, 0.65, 0.8), (0.05, 0.15, 0.3, 0.5, 0.75)
OVER, SHARPEST, WIDEST, CLOSE = 0.06, 0.002, 0.1, 0.02
SLOPES = ("lean", 4.0), ("bend", 16.0), ("third", 32.0), ("fourth", 64.0)


def snapped(signal: np.ndarray, values: np.ndarray, start: float) -> np.ndarray:
    """The relay's course (n,), from -1 to 1, under a signal (n,), from where it starts."""
    middle, apart, over = values[1:4]
    upper, lower = middle + 0.5 * apart, middle - 0.5 * apart
    least = 2.0 * np.clip((signal - upper) / over, 0.0, 1.0) - 1.0
    most = 2.0 * np.clip((signal - lower) / over + 1.0, 0.0, 1.0) - 1.0
    return np.asarray(varying_play(0.5 * (least + most), 0.5 * (most - least), start))


def slope_of(power: int, around: Surroundings) -> Parameter:
    """What the height goes by with a power of the angle from the middle, over the height."""
    name, times = SLOPES[power - 1]
    most = times / around.angle_span**power
    unit = f"1/{around.angle_unit}" + (f"^{power}" if power > 1 else "")
    return Parameter(name, unit, -most, most, 0.0, 0.3 * most)


class SnappingJoint(Term):
    """x = u + h(u) r: a relay r that goes from 0 to 1 above an upper place, back below a lower one.

    They lie `apart`, round `middle`. It is at 1 `over` beyond the upper place, and at 0 as far
    below the lower one; between the two it stays as it is, at first at 0. h is `height`, in form
    "bent" height (1 + lean z + bend z^2), z = u - middle, in form "curved" with z^3 and z^4 as
    well: each rest has a curve of its own. The catalogue has no name for it: it stands where
    friction does. Source: the relay, or hysteron, of Preisach's model (Mayergoyz, Mathematical
    Models of Hysteresis (1991), section 1.1); of a bistable joint, snap-through.
    """

    name = Friction.name
    form = "snapping"
    grows: ClassVar = {"snapping": (BENT,), BENT: (CURVED,)}
    site = Friction.site
    place = 100.0
    remembers = "way"
    unlikely = UNUSUAL
    nameless = True
    beyond = "a snap from one rest to another, at two places"
    says = "The joint snaps by {height}."

    @property
    def powers(self) -> int:
        """How many powers of the angle its height goes by."""
        return {BENT: 2, CURVED: 4}.get(self.form, 0)

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        span, low, unit = around.angle_span, around.angle_low, around.angle_unit
        own = (
            Parameter("height", unit, -0.4 * span, 0.4 * span, 0.03 * span, 0.03 * span),
            Parameter("middle", unit, low, low + span, low + 0.5 * span, 0.0),
            Parameter("apart", unit, 0.0, 0.95 * span, 0.3 * span, 0.0),
            Parameter("over", unit, SHARPEST * span, WIDEST * span, OVER * span, 0.0, weak=True),
        )
        return (*own, *(slope_of(k, around) for k in range(1, self.powers + 1)))

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        at = snapped(signal, values, -1.0 if state is None else float(state[0]))
        height, middle = values[:2]
        shape = np.polynomial.polynomial.polyval(signal - middle, np.append(1.0, values[4:]))
        return signal + 0.5 * height * shape * (at + 1.0), at[-1:].copy()

    def slight(self, values: np.ndarray, around: Surroundings) -> bool:
        """What returns where it left is no snap, but a bend of the curve."""
        return bool(values[2] < CLOSE * around.angle_span)

    def leaps(self, motion: Motion, angle: np.ndarray, values: np.ndarray) -> np.ndarray:
        """Where it snaps, and the samples next to it: how far it had come by then says nothing."""
        moves = np.diff(snapped(angle, values, -1.0), prepend=-1.0) != 0.0
        moves[0] = False
        near = np.append(moves[1:], False)
        return np.asarray(moves | near | np.append(False, moves[:-1]))

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        span, low = around.angle_span, around.angle_low
        even = [0.0] * self.powers
        return np.array(
            [
                [0.03 * span, low + middle * span, apart * span, OVER * span, *even]
                for middle in MIDDLES
                for apart in APARTS
                if 0.5 * apart < min(middle, 1.0 - middle) - OVER
            ]
        )

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        return around.spacing < OVER * around.drive_span

    def sentence(self, values: np.ndarray, around: Surroundings) -> str:
        height, middle, apart = values[:3]
        unit, way = around.angle_unit, "ahead" if height > 0.0 else "back"
        return (
            f"The joint snaps {way} by {worded(abs(height))} {unit} where it rises beyond "
            f"{worded(middle + 0.5 * apart)} {unit}, and returns below "
            f"{worded(middle - 0.5 * apart)} {unit}."
        )

"""How hard a wire in its sheath is pulled: friction takes a share of the pull, place by place."""

import numpy as np
from numba import njit

from pipeline.physics.force_term import ForceTerm, per, size
from pipeline.physics.force_units import FORCES, LENGTHS
from pipeline.physics.motion import Kinetics, Motion
from pipeline.physics.term import Parameter, Surroundings

PLACES = 16
LEAST_PULL = 1e-9
MOST_STEPS, EXACT = 40, 1e-11
FARTHEST_HOME, PUSHED = 20.0, 0.25


@njit(cache=True)
def near_pulls(ways, least, most, weights, state):  # type: ignore[no-untyped-def]
    """The pull at the near end, (n,), where the weighted pulls of all places sum up to ways (n,).

    state: (places,) the pull at each place (in place); it lies between least and most times the
    pull at the near end. Steps along the slope of such a sum of edges end on it.
    """
    out = np.empty(ways.size)
    near = state[0]
    for i in range(ways.size):
        for _ in range(MOST_STEPS):
            total, slope = 0.0, 0.0
            for j in range(state.size):
                low, high = least[j] * near, most[j] * near
                total += weights[j] * max(low, min(high, state[j]))
                if state[j] < low:
                    slope += weights[j] * least[j]
                elif state[j] > high:
                    slope += weights[j] * most[j]
            off = ways[i] - total
            if abs(off) <= EXACT * ways[i]:
                break
            if slope > 0.0:
                near = max(near + off / slope, LEAST_PULL)
            elif off > 0.0:
                near = (1.0 + EXACT) * state[0] / least[0]
            else:
                near = (1.0 - EXACT) * state[0] / most[0]
        for j in range(state.size):
            state[j] = max(least[j] * near, min(most[j] * near, state[j]))
        out[i] = near
    return out


@njit(cache=True)
def far_pulls(ways, ratio, state):  # type: ignore[no-untyped-def]
    """The pull at the far end, (n,): what it was, as long as it may differ from ways by `ratio`."""
    out = np.empty(ways.size)
    for i in range(ways.size):
        state[0] = max(ways[i] / ratio, min(ways[i] * ratio, state[0]))
        out[i] = state[0]
    return out


class SheathForce(ForceTerm):
    """F = stiffness (pull - way): by how much friction changes the pull at one end of a wire.

    A way goes in at the near end, a spring pulls at the far end. At a share s of the wire the pull
    is between exp(-w) and exp(w) times that at the near end, w = wrap s^where, and stays what it
    was as long as it may; wire and spring together give way by what goes in: (1 - load) mean + load
    far = way, way = position + pretension in the position's unit. stiffness: of wire and spring in
    series; load: the spring's share in what gives way; wrap, where: see `sheath_stretch.py`. Form
    "near" is the pull at the near end. At the far end that is a play in log(way), of `half` to
    either side: form "far". Where "falling", a falling position pulls, and a pull counts as
    negative. It begins without friction. Source: as in `sheath_stretch.py`.
    """

    name = "coulomb_friction"
    place = 110.0
    remembers = "way"
    says_of_near = (
        "The sheath holds the wire back by a share of its pull: while it slides, the pulls at its "
        "ends differ by a factor of exp({wrap})."
    )
    says_of_far = (
        "The sheath holds the wire back by a share of its pull: at the far end the two ways differ "
        "by a factor of exp(2 x {half})."
    )

    def __init__(self, form: str = "near") -> None:
        super().__init__(form)
        self.near = "near" in form
        self.pulling = -1.0 if "falling" in form else 1.0
        self.says = self.says_of_near if self.near else self.says_of_far  # type: ignore[misc]

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        span = max(around.drive_span, 1e-12)
        home = -around.drive_low if self.pulling > 0.0 else around.drive_low + span
        own: tuple[Parameter, ...] = (Parameter("half", "", 0.0, 2.0, 0.15, 0.1),)
        if self.near:
            own = (
                Parameter("wrap", "", 0.0, 5.0, 0.3, 0.2),
                Parameter("load", "", 0.0, 1.0, 0.5, 0.3),
                Parameter("where", "", 0.2, 5.0, 1.0, 0.5),
            )
        return (
            size("stiffness", per(around, 0), 4.0 * around.angle_span / span, around, usual=0.25),
            *own,
            Parameter("pretension", around.drive_unit, home + 1e-3 * span,
                      home + FARTHEST_HOME * span, home + 0.3 * span, 0.5 * span),
        )  # fmt: skip

    def force(
        self, motion: Motion, kinetics: Kinetics, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray | None]:
        stiffness, wrap, pretension = float(values[0]), float(values[1]), float(values[-1])
        way = np.maximum(self.pulling * motion.drive + pretension, LEAST_PULL)
        at = np.full(PLACES + 1, way[0]) if state is None else state.copy()
        if not self.near:
            return self.pulling * stiffness * (far_pulls(way, np.exp(wrap), at) - way), at
        load, where = float(values[2]), float(values[3])
        share = np.append((np.arange(PLACES) + 0.5) / PLACES, 1.0) ** where
        weights = np.append(np.full(PLACES, (1.0 - load) / PLACES), load)
        pull = near_pulls(way, np.exp(-wrap * share), np.exp(wrap * share), weights, at)
        return self.pulling * stiffness * (pull - way), at

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        stiffness, *_, pretension = self.parameters(around)
        homes = [pretension.low + far * around.drive_span for far in (0.1, 1.0)]
        own: list[tuple[float, ...]] = [(half,) for half in (0.1, 0.3)]
        if self.near:
            own = [(wrap, load, 1.0) for wrap in (0.1, 0.4, 1.0) for load in (0.3, 0.9)]
        return np.array([[stiffness.start, *values, home] for values in own for home in homes])

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        """Where a length goes in and the force measured has about one sign: a wire only pulls."""
        units = around.drive_unit in LENGTHS and around.angle_unit in FORCES
        low, span = around.angle_low, around.angle_span
        pulled = low > -PUSHED * span if self.pulling > 0.0 else low + span < PUSHED * span
        return units and pulled and super().excited(motion, around)

    def void(self, values: np.ndarray) -> bool:
        return bool(values[0] == 0.0 or values[1] == 0.0)

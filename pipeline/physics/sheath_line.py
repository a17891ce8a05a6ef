"""An elastic wire in a sheath, pulled against a spring: it gives way place by place."""

import numpy as np
from numba import njit

from pipeline.physics.backlash import Backlash
from pipeline.physics.motion import Motion
from pipeline.physics.term import Parameter, Surroundings, Term

PLACES = 8
MOST_ROUNDS = 40
FIRM, NEARLY_EVEN = 1e-6, 0.3
RUBS, WRAPS, STRETCHES = (0.02, 0.08), (0.1, 0.5), (0.1, 0.5)


@njit(cache=True, error_model="numpy")
def _carried_on(near, rub, wrap, pretension, before, pull):  # type: ignore[no-untyped-def]
    """What is pulled at each place (in place) where `near` is pulled at the first; their slopes.

    Mean of the pulls ahead of each place and its slope, then the last pull and its slope.
    """
    total, steep, slope, here = 0.0, 0.0, 1.0, near
    for j in range(before.size):
        total, steep = total + here, steep + slope
        held = rub + wrap * abs(here + pretension)
        growth = wrap * slope if here + pretension >= 0.0 else -wrap * slope
        if before[j] < here - held:
            pull[j], slope = here - held, slope - growth
        elif before[j] > here + held:
            pull[j], slope = here + held, slope + growth
        else:
            pull[j], slope = before[j], 0.0
        here = pull[j]
    return total / before.size, steep / before.size, here, slope


@njit(cache=True, error_model="numpy")
def _lined(asked, rub, wrap, stretch, pretension, near, pulls):  # type: ignore[no-untyped-def]
    out, pull = np.empty(asked.size), np.empty(pulls.size)
    whole = 1.0 + stretch
    for i in range(asked.size):
        low, high = -np.inf, np.inf
        for _ in range(MOST_ROUNDS):
            mean, steep, last, slope = _carried_on(near, rub, wrap, pretension, pulls, pull)
            off = asked[i] - (last + stretch * mean) / whole
            if abs(off) <= FIRM * (abs(asked[i]) + rub):
                break
            low, high = (near, high) if off > 0.0 else (low, near)
            near += off * whole / max(slope + stretch * steep, FIRM)
            if not low < near < high:
                near = 0.5 * (low + high)
        pulls[:] = pull
        out[i] = pull[-1]
    return out, near


class SheathLine(Term):
    """u (1 + stretch) = x + stretch * mean over the wire of its pull T, x being T at its far end.

    Pulls are counted in the way of the spring there. From one of PLACES to the next at most rub +
    wrap |T + pretension|, over PLACES, is lost of it: T at a place is a play of what it is at the
    one before, whose width grows with that. So after each reversal the change sets in at the near
    end and wanders to the far one, which stands still until it comes there. It begins with as
    much pull everywhere.
    Source: capstan equation (Euler 1769; Eytelwein 1808) of an elastic wire, place by place as in
    Kaneko et al., IEEE Trans. Robot. Autom. 7 (1991) 351; Palli, Borghesan and Melchiorri, IEEE
    Trans. Robot. 28 (2012) 277.
    """

    name = "friction"
    site = "transmission"
    place = 60.0
    form = "sheath line"
    remembers = "way"
    before_curve = True
    says = (
        "The wire rubs all along its sheath, by {rub} and by {wrap} of its pull, and stretches by "
        "{stretch} of the way at its far end."
    )

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        span, unit = around.drive_span, around.drive_unit
        return (
            Parameter("rub", unit, 0.0, span, 0.05 * span, 0.05 * span, at_drive=True),
            Parameter("wrap", "", 0.0, 5.0, 0.3, 0.2),
            Parameter("stretch", "", 1e-3, 5.0, 0.3, 0.3),
            Parameter("pretension", unit, -span, 5.0 * span, 0.0, 0.2 * span, at_drive=True),
        )

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        pulls = np.full(PLACES + 1, float(signal[0])) if state is None else state.copy()
        rub, wrap, stretch, pretension = (float(v) for v in values)
        out, near = _lined(
            np.ascontiguousarray(signal), rub / PLACES, wrap / PLACES, stretch, pretension,
            pulls[0], pulls[1:],
        )  # fmt: skip
        pulls[0] = near
        return out, pulls

    def also_at(self, values: np.ndarray, around: Surroundings) -> tuple[str, ...]:
        """Play, as which its far end stands still after each turn, where it loses as much anywhere.

        Then it is that, however much the wire stretches.
        """
        rub, wrap, _, pretension = values
        more = wrap * 0.5 * around.drive_span
        return (Backlash.name,) if more < NEARLY_EVEN * (rub + wrap * abs(pretension)) else ()

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        span = around.drive_span
        return np.array([[r * span, w, s, 0.0] for r in RUBS for w in WRAPS for s in STRETCHES])

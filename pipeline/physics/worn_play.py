"""Play that differs from place to place: teeth wear where they are used most."""

import numpy as np

from pipeline.number_words import worded
from pipeline.physics.backlash import Backlash
from pipeline.physics.motion import Motion
from pipeline.physics.play_operator import varying_play
from pipeline.physics.term import Parameter, Surroundings, Term

PLACES = 9
RARELY = 10.0


def places(values: np.ndarray) -> np.ndarray:
    """Where the gaps are known, (PLACES,) [drive unit], of all parameters."""
    first, last = values[PLACES:]
    return np.linspace(first, last, PLACES)


class WornPlay(Term):
    """x_k = max(u_k - w(u_k)/2, min(u_k + w(u_k)/2, x_{k-1})), w being straight between PLACES.

    It starts in the middle of its gap. The places lie evenly from `first_place` to `last_place`,
    beyond which the gap stays. Source: the play operator with a width that changes, Krasnosel'skii
    and Pokrovskii, Systems with Hysteresis (1989), section 2.
    """

    name = Backlash.name
    site = Backlash.site
    place = Backlash.place
    remembers = "way"
    before_curve = True
    group = Backlash.group
    form = "worn"
    unlikely = RARELY
    beyond = "how wide the play is at each place"

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        span, unit = around.drive_span, around.drive_unit
        first, last = around.drive_low, around.drive_low + span
        usual = 0.05 * span
        return (
            *(
                Parameter(f"width_{k + 1}", unit, 0.0, 0.9 * span, usual, usual)
                for k in range(PLACES)
            ),
            Parameter("first_place", unit, first, first, first, 0.0, weak=True),
            Parameter("last_place", unit, last, last, last, 0.0, weak=True),
        )

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        start = float(signal[0]) if state is None else float(state[0])
        gap = np.interp(signal, places(values), values[:PLACES])
        out = varying_play(signal, 0.5 * gap, start)
        return out, out[-1:].copy()

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        span, place = around.drive_span, np.linspace(0.0, 1.0, PLACES)
        ends = around.drive_low, around.drive_low + span
        return np.array(
            [
                [*(span * (width + wear * np.exp(-(((place - most) / reach) ** 2)))), *ends]
                for width in (0.0, 0.02)
                for wear in (0.02, 0.08)
                for most in (0.1, 0.3, 0.5, 0.7, 0.9)
                for reach in (0.12, 0.25)
            ]
        )

    def scaled(self, values: np.ndarray, factor: float) -> np.ndarray:
        return np.concatenate([factor * values[:PLACES], values[PLACES:]])

    def void(self, values: np.ndarray) -> bool:
        return not np.any(values[:PLACES] > 0.0)

    def sentence(self, values: np.ndarray, around: Surroundings) -> str:
        unit, gaps, place = around.drive_unit, values[:PLACES], places(values)
        most, least = int(np.argmax(gaps)), int(np.argmin(gaps))
        return (
            "The drive turns through play after each reversal before anything moves, "
            f"{worded(gaps[most])} {unit} of it at {worded(place[most])} {unit}, "
            f"{worded(gaps[least])} {unit} at {worded(place[least])} {unit}. "
            "How it differs has no name in the catalogue, but the corrected simulation has it."
        )

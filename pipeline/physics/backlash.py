"""Play: lost motion with sharp corners after each reversal."""

from dataclasses import replace

import numpy as np
from numba import njit

from pipeline.number_words import worded
from pipeline.physics.coasting_play import CoastingPlay
from pipeline.physics.motion import Motion
from pipeline.physics.term import Parameter, Surroundings, Term

PLACES, RARELY = 9, 10.0


@njit(cache=True)
def play(drive: np.ndarray, half_width: float, start: float) -> np.ndarray:
    """The play operator: the output moves only when it is pushed by an end of the gap."""
    out = np.empty(drive.size)
    at = start
    for i in range(drive.size):
        if drive[i] - half_width > at:
            at = drive[i] - half_width
        elif drive[i] + half_width < at:
            at = drive[i] + half_width
        out[i] = at
    return out


@njit(cache=True)
def varying_play(drive, half_width, at):  # type: ignore[no-untyped-def]
    """The play operator, (n,), with a gap of its own for each sample."""
    out = np.empty(drive.size)
    for i in range(drive.size):
        half = half_width[i]
        at = max(at, drive[i] - half) if drive[i] - half > at else min(at, drive[i] + half)
        out[i] = at
    return out


def places(values: np.ndarray) -> np.ndarray:
    """Where the gaps of form "worn" are known, (PLACES,), of its parameters."""
    first, last = values[PLACES:]
    return np.linspace(first, last, PLACES)


class Backlash(Term):
    """x_k = max(u_k - w/2, min(u_k + w/2, x_{k-1})), with the gap w in the drive's unit.

    It starts in the middle of its gap. Form "worn" has another gap w(u) at each place, straight
    between PLACES of them from `first_place` to `last_place`: teeth wear where they are used most.
    Source: the play operator, Krasnosel'skii and Pokrovskii, Systems with Hysteresis (1989),
    section 2.
    """

    name = "backlash"
    site = "transmission"
    remembers = "way"
    before_curve = True
    group = "play"
    says = "The drive turns through {width} of play after each reversal before anything moves."

    def __init__(self, form: str = "") -> None:
        self.form = form
        self.unlikely = RARELY if form == "worn" else 0.0
        self.beyond = "in how wide the play is at each place" if form == "worn" else ""

    def richer(self) -> tuple[Term, ...]:
        return () if self.form else (CoastingPlay(),)

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        span, unit = around.drive_span, around.drive_unit
        width = Parameter("width", unit, 0.0, 0.9 * span, 0.05 * span, 0.05 * span)
        if self.form != "worn":
            return (width,)
        first, last = around.drive_low, around.drive_low + span
        return (
            *(replace(width, name=f"width_{k + 1}") for k in range(PLACES)),
            Parameter("first_place", unit, first, first, first, 0.0, weak=True),
            Parameter("last_place", unit, last, last, last, 0.0, weak=True),
        )

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        start = float(signal[0]) if state is None else float(state[0])
        if self.form == "worn":
            gap = np.interp(signal, places(values), values[:PLACES])
            out = varying_play(signal, 0.5 * gap, start)
        else:
            out = play(signal, 0.5 * float(values[0]), start)
        return out, out[-1:].copy()

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        span = around.drive_span
        if self.form != "worn":
            return span * np.array([[0.003], [0.01], [0.03], [0.07], [0.15], [0.3]])
        place = np.linspace(0.0, 1.0, PLACES)
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
        out = values.copy()
        out[:PLACES] *= factor
        return out

    def void(self, values: np.ndarray) -> bool:
        return not np.any(values[:PLACES] > 0.0)

    def sentence(self, values: np.ndarray, around: Surroundings) -> str:
        if self.form != "worn":
            return super().sentence(values, around)
        unit, gaps = around.drive_unit, values[:PLACES]
        place = places(values)
        most, least = int(np.argmax(gaps)), int(np.argmin(gaps))
        return (
            f"The drive turns through play after each reversal before anything moves, "
            f"{worded(gaps[most])} {unit} of it at {worded(place[most])} {unit}, "
            f"{worded(gaps[least])} {unit} at {worded(place[least])} {unit}."
        )

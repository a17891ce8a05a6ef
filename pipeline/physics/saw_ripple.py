"""A saw: a ripple with one sharp edge in each period, as what counts in coarse steps leaves it."""

from collections.abc import Sequence

import numpy as np

from pipeline.number_words import worded
from pipeline.physics.motion import Motion
from pipeline.physics.off_centre_ripple import OffCentreRipple
from pipeline.physics.term import Parameter, Surroundings, Told
from pipeline.physics.transmission_ripple import TransmissionRipple

SHARP, EVENLY, AT_EDGE = 0.998, 0.15, 0.02
STAIRS = "stairs of one size, flat between their edges, as of a coarse count"


class SawRipple(OffCentreRipple):
    """x = u + amplitude / e atan2(e sin a, 1 - e cos a), a = 2 pi u / period + phase, e = SHARP.

    It falls from one edge to the next by pi amplitude in all. Where that is about a period, it
    takes back all that the drive runs on: stairs, as of a count, which no name of the catalogue
    says. Source: Fourier series of a saw, of which e rounds the edges.
    """

    form = "saw afloat"

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        return TransmissionRipple.parameters(self, around)

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        return super().respond(signal, motion, np.append(values, SHARP), state)

    def waves(self, values: np.ndarray) -> np.ndarray:
        return super().waves(np.append(values, SHARP))

    def slight(self, values: np.ndarray, around: Surroundings) -> bool:
        return super().slight(np.append(values, SHARP), around)

    def beyond_at(self, values: np.ndarray, around: Surroundings) -> str:
        amplitude, period, _ = values
        return STAIRS if abs(np.pi * amplitude / period - 1.0) < EVENLY else ""

    def sentence(self, values: np.ndarray, around: Surroundings) -> str:
        unit, (amplitude, period, _) = around.drive_unit, values
        if self.beyond_at(values, around):
            return f"The drive comes in stairs of {worded(period)} {unit}, as of a coarse count."
        falls = f"by {worded(np.pi * amplitude)} {unit}"
        return f"The drive leaps ahead {falls} and falls back, every {worded(period)} {unit} anew."

    def at_edge(self, drive: np.ndarray, values: np.ndarray) -> np.ndarray:
        """Where a drive (n,) is so near to an edge that it may be on either side of it."""
        _, period, phase = values
        turns = drive / period + phase / (2.0 * np.pi)
        return np.asarray(np.abs(turns - np.round(turns)) < AT_EDGE)

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        return self.plain_waves(around)

    def instead(self, values: np.ndarray, motion: Motion, around: Surroundings) -> Sequence[Told]:
        return ()

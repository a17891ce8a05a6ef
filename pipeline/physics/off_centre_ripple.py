"""The ripple of a wheel that turns about a point off its centre."""

from collections.abc import Sequence
from typing import ClassVar

import numpy as np
from numba import njit

from pipeline.physics.motion import Motion
from pipeline.physics.tabled import waved
from pipeline.physics.term import NO_STATE, Parameter, Surroundings, Told
from pipeline.physics.transmission_ripple import EDGES, TransmissionRipple

FARTHEST, CENTRED, EDGED = 0.9, 1e-6, 0.6
TEETH = TransmissionRipple("both afloat")


@njit(cache=True, fastmath=True, error_model="numpy")
def off_centred(drive, amplitude, turn, phase, off):  # type: ignore[no-untyped-def]
    """drive + amplitude / off atan2(off sin a, 1 - off cos a), a = turn drive + phase, (n,)."""
    out = np.empty(drive.size)
    for i in range(drive.size):
        sine, cosine = waved(turn * drive[i] + phase)
        if abs(off) > CENTRED:
            sine = np.arctan2(off * sine, 1.0 - off * cosine) / off
        out[i] = drive[i] + amplitude * sine
    return out


class OffCentreRipple(TransmissionRipple):
    """x = u + amplitude / e atan2(e sin a, 1 - e cos a), a = 2 pi u / period + phase.

    e is how far off it turns over its radius; where it is 0 that is a plain wave. Its harmonics are
    amplitude e^(k - 1) / k sin(k a). Where it is EDGED the wave has an edge, which the drive meets
    three times, as of teeth that seat, or it is no ripple. Source: law of sines; as of one ripple.
    """

    form = "eccentric afloat"
    grows: ClassVar = {}

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        off = Parameter("eccentricity", "", -FARTHEST, FARTHEST, 0.3, 0.3)
        return *super().parameters(around), off

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        amplitude, period, phase, off = values.tolist()
        return off_centred(signal, amplitude, 2.0 * np.pi / period, phase, off), NO_STATE

    def waves(self, values: np.ndarray) -> np.ndarray:
        amplitude, _, phase, off = values
        times = np.arange(1, 1 + max(TEETH.overtones))
        sizes = amplitude * off ** (times - 1) / times
        return np.column_stack([times, np.abs(sizes), times * phase + np.pi * (sizes < 0.0)])

    def slight(self, values: np.ndarray, around: Surroundings) -> bool:
        return bool(abs(values[3]) > EDGED and around.drive_span < EDGES * values[1])

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        return np.array([[*r, e] for r in self.plain_waves(around) for e in (-0.3, 0.3)])

    def instead(self, values: np.ndarray, motion: Motion, around: Surroundings) -> Sequence[Told]:
        """Teeth with as large harmonics: of those that go their own way it follows one."""
        (_, first, phase), *overtones = self.waves(values)
        told = [first, values[1], phase, *np.concatenate([o[1:] for o in overtones])]
        return [[(TEETH, np.array(told))]]

    def sentence(self, values: np.ndarray, around: Surroundings) -> str:
        said = super().sentence(values, around)
        return f"{said} It is uneven, as a wheel's that turns about a point off its centre."

"""A ripple of which the drive runs through hardly more than one wave: a pulley off its centre."""

from collections.abc import Sequence
from dataclasses import replace
from typing import ClassVar

import numpy as np

from pipeline.physics.motion import Motion
from pipeline.physics.off_centre_ripple import OffCentreRipple
from pipeline.physics.term import Parameter, Surroundings, Told
from pipeline.physics.transmission_ripple import TransmissionRipple

SHORTEST, LONGEST, PERIODS, PHASES = 0.75, 2.0, 9, 8
ONE_BEND, BENDS = 1.3, ("camera_tilt", "compliance", "gravity", "lens_distortion")
UNUSUAL = 8.0  # of fifty bends one: most are a joint's or a camera's


class LongRipple(TransmissionRipple):
    """x = u + a sin(2 pi u / period + phase), its wave SHORTEST to LONGEST of the drive's range.

    Longer ones bend as a parabola or a cubic does, and so as a camera's view or a weight may.
    Source: as of one ripple.
    """

    form = "long afloat"
    grows: ClassVar = {}
    unlikely = UNUSUAL

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        return long(super().parameters(around), around)

    def plain_waves(self, around: Surroundings) -> np.ndarray:
        return long_waves(around)

    def also_at(self, values: np.ndarray, around: Surroundings) -> tuple[str, ...]:
        return bends_alike(values, around)


class LongOffCentreRipple(OffCentreRipple):
    """As long a wave of a wheel that turns about a point off its centre (`off_centre_ripple.py`).

    A universal joint at an angle beta leaves just that, twice a turn: its e is tan^2(beta / 2).
    Source: Seherr-Thoss, Schmelz and Aucktor, Universal Joints and Driveshafts (2006).
    """

    form = "long eccentric afloat"
    unlikely = UNUSUAL

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        return long(super().parameters(around), around)

    def plain_waves(self, around: Surroundings) -> np.ndarray:
        return long_waves(around)

    def instead(self, values: np.ndarray, motion: Motion, around: Surroundings) -> Sequence[Told]:
        return ()

    def also_at(self, values: np.ndarray, around: Surroundings) -> tuple[str, ...]:
        return bends_alike(values, around)


def bends_alike(values: np.ndarray, around: Surroundings) -> tuple[str, ...]:
    """What bends a curve as well as a wave does of which the drive sees about one bend."""
    return BENDS if values[1] > ONE_BEND * around.drive_span else ()


def long(parameters: tuple[Parameter, ...], around: Surroundings) -> tuple[Parameter, ...]:
    """A ripple's parameters, its period longer than the others'."""
    amplitude, period, *rest = parameters
    low, high = SHORTEST * around.drive_span, LONGEST * around.drive_span
    return amplitude, replace(period, low=low, high=high, start=0.5 * (low + high)), *rest


def long_waves(around: Surroundings) -> np.ndarray:
    """Amplitude, period and phase of such waves to begin a search from, (k, 3)."""
    span, turns = around.drive_span, np.arange(PHASES) * np.pi / PHASES
    often = np.linspace(1.0 / LONGEST, 1.0 / SHORTEST, PERIODS) / span
    return np.array([[0.01 * span, 1.0 / f, turn] for f in often for turn in turns])

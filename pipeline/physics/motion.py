"""What drives a mechanism: times, commands and cycles of a block of samples."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from pipeline.physics.delay import delayed


@dataclass(frozen=True)
class Kinetics:
    """What a force against motion goes by, each (n,).

    velocity [drive unit/s], acceleration [drive unit/s^2]. simulated: the force that the
    simulation says already [measurement's unit].
    """

    velocity: np.ndarray
    acceleration: np.ndarray
    simulated: np.ndarray

    def rows(self, part: slice | np.ndarray) -> "Kinetics":
        """The same for some of the samples."""
        return Kinetics(self.velocity[part], self.acceleration[part], self.simulated[part])


def zero_of(values: np.ndarray) -> float:
    """From where values (n,) count: 0 if it is between them, else where they began."""
    return 0.0 if np.min(values) <= 0.0 <= np.max(values) else float(values[0])


@dataclass(frozen=True)
class Motion:
    """A block of n samples in the order of time.

    drive: (n,) what goes into the chain: the axis's own command [its unit], or the trace of a
        simulation that is no static curve of the command [the measurement's unit]; the position
        where a force is measured.
    time_s: (n,) when each sample was taken.
    cycle: (n,) number of the cycle, from 0.
    others: the other axes' commands by name, each (n,).
    radian: how many angle units a radian has.
    zeros: from which value of each other command a coupling counts; 0 of those not named.
    kinetics: None unless a force is measured against the motion.
    """

    drive: np.ndarray
    time_s: np.ndarray
    cycle: np.ndarray
    others: Mapping[str, np.ndarray] = field(default_factory=dict)
    radian: float = 180.0 / np.pi
    kinetics: Kinetics | None = None
    zeros: Mapping[str, float] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.drive)

    def delayed(self, delay_s: float) -> "Motion":
        """The same times, at each of which the motion is what it was `delay_s` before."""
        if delay_s == 0.0:
            return self

        def before(values: np.ndarray) -> np.ndarray:
            return delayed(self.time_s, values, delay_s)

        kinetics = self.kinetics
        if kinetics is not None:
            columns = kinetics.velocity, kinetics.acceleration, kinetics.simulated
            kinetics = Kinetics(*(before(column) for column in columns))
        others = {name: before(values) for name, values in self.others.items()}
        return replace(self, drive=before(self.drive), others=others, kinetics=kinetics)

    @cached_property
    def dwell_s(self) -> np.ndarray:
        """Time that each command had before its sample was taken, (n,); none the first."""
        return np.diff(self.time_s, prepend=self.time_s[:1])

    @cached_property
    def stands(self) -> np.ndarray:
        """Whether all commands are what they were one sample before, (n,); not the first."""
        out = np.zeros(len(self.drive), dtype=bool)
        out[1:] = np.all([np.diff(u) == 0.0 for u in (self.drive, *self.others.values())], axis=0)
        return out

    def rows(self, part: slice | np.ndarray) -> "Motion":
        """The same motion over some of its samples (a slice or indices)."""
        return replace(
            self,
            drive=self.drive[part],
            time_s=self.time_s[part],
            cycle=self.cycle[part],
            others={name: values[part] for name, values in self.others.items()},
            kinetics=None if self.kinetics is None else self.kinetics.rows(part),
        )

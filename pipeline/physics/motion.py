"""What drives a mechanism: times, commands and cycles of a block of samples."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from pipeline.physics.corners import Corners
from pipeline.physics.delay import delayed
from pipeline.physics.even_grid import quantum_of

MOSTLY, FEWEST_STAIRS = 0.5, 3


@dataclass(frozen=True)
class Kinetics:
    """What a force against motion goes by, each (n,).

    velocity [drive unit/s], acceleration [drive unit/s^2]. simulated: the force that the
    simulation says already [measurement's unit]. turned: where the drive turned round on its way
    from the sample before, the drive's own value where it did not; empty where none is known.
    """

    velocity: np.ndarray
    acceleration: np.ndarray
    simulated: np.ndarray
    turned: np.ndarray = field(default_factory=lambda: np.zeros(0))

    def rows(self, part: slice | np.ndarray) -> "Kinetics":
        """The same for some of the samples."""
        turned = self.turned[part] if len(self.turned) else self.turned
        return Kinetics(self.velocity[part], self.acceleration[part], self.simulated[part], turned)


def turned_between(time_s: np.ndarray, drive: np.ndarray, velocity: np.ndarray) -> np.ndarray:
    """Where a drive turned round between two samples, (n,), at the later one; its value elsewhere.

    What remembers travel remembers the very turn: the extreme of the cubic that has both samples'
    values and velocities (Hermite's).
    """
    out = np.array(drive, dtype=float)
    k = np.flatnonzero(velocity[:-1] * velocity[1:] < 0.0)
    h, x, to = np.diff(time_s)[k], drive[k], drive[k + 1]
    v, w = velocity[k] * h, velocity[k + 1] * h
    cube, square = 2.0 * (x - to) + v + w, 3.0 * (to - x) - 2.0 * v - w
    root = np.sqrt(np.maximum(square**2 - 3.0 * cube * v, 0.0))
    below = square + np.where(square >= 0.0, root, -root)
    firsts = -v / np.where(below == 0.0, np.inf, below)
    others = -below / np.where(cube == 0.0, np.inf, 3.0 * cube)
    u = np.where((firsts > 0.0) & (firsts < 1.0), firsts, others)
    turn = x + u * (v + u * (square + u * cube))
    there = (u > 0.0) & (u < 1.0) & ((turn - x) * (turn - to) > 0.0)
    out[k[there] + 1] = turn[there]
    return out


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
    corners: where the commands turned between samples, if that is known.
    """

    drive: np.ndarray
    time_s: np.ndarray
    cycle: np.ndarray
    others: Mapping[str, np.ndarray] = field(default_factory=dict)
    radian: float = 180.0 / np.pi
    kinetics: Kinetics | None = None
    zeros: Mapping[str, float] = field(default_factory=dict)
    corners: Corners | None = None

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
            velocity = before(kinetics.velocity)
            kinetics = Kinetics(
                velocity,
                before(kinetics.acceleration),
                before(kinetics.simulated),
                turned_between(self.time_s, before(self.drive), velocity),
            )
        others = {name: before(values) for name, values in self.others.items()}
        return replace(self, drive=before(self.drive), others=others, kinetics=kinetics)

    @cached_property
    def way(self) -> tuple[np.ndarray, np.ndarray]:
        """All that the drive went through, (m,), turns between samples too, and where samples are.

        The latter (n,) are places in the former.
        """
        rows = np.arange(len(self.drive))
        if self.kinetics is None or not len(self.kinetics.turned):
            return np.ascontiguousarray(self.drive), rows
        extra = self.kinetics.turned != self.drive
        went = np.insert(self.drive, np.flatnonzero(extra), self.kinetics.turned[extra])
        return went, rows + np.cumsum(extra)

    @cached_property
    def whole(self) -> "tuple[Motion, np.ndarray]":
        """The motion with its corners among its samples, and where these are then, (n,)."""
        rows = np.arange(len(self.drive))
        if self.corners is None:
            return self, rows
        places = np.searchsorted(self.time_s, self.corners.time_s)
        inside = (places > 0) & (places < len(rows))
        when, told = places[inside], self.corners
        others = {
            name: np.insert(values, when, told.others[name][inside])
            for name, values in self.others.items()
        }
        whole = replace(
            self,
            drive=np.insert(self.drive, when, told.drive[inside]),
            time_s=np.insert(self.time_s, when, told.time_s[inside]),
            cycle=np.insert(self.cycle, when, self.cycle[when - 1]),
            others=others,
            corners=None,
        )
        return whole, rows + np.searchsorted(when, rows, side="right")

    @cached_property
    def cycle_begins(self) -> np.ndarray:
        """The first row of each cycle, and the number of rows, (cycles + 1,)."""
        begins = np.flatnonzero(np.diff(self.cycle, prepend=self.cycle[:1] - 1))
        return np.append(begins, len(self.cycle))

    @cached_property
    def dwell_s(self) -> np.ndarray:
        """Time that each command had before its sample was taken, (n,); none the first."""
        return np.diff(self.time_s, prepend=self.time_s[:1])

    @cached_property
    def usual_dwell_s(self) -> float:
        """Median time from one sample to the next; NaN of a single one."""
        return float(np.median(np.diff(self.time_s))) if len(self.time_s) > 1 else np.nan

    @cached_property
    def stood_s(self) -> np.ndarray:
        """How long the drive was at each of the values it went through, (m,)."""
        anew = np.append(np.flatnonzero(np.diff(self.drive, prepend=np.nan)), len(self.drive) - 1)
        return np.diff(self.time_s[anew])

    @cached_property
    def stands(self) -> np.ndarray:
        """Whether all commands are what they were one sample before, (n,); not the first."""
        out = np.zeros(len(self.drive), dtype=bool)
        out[1:] = np.all([np.diff(u) == 0.0 for u in (self.drive, *self.others.values())], axis=0)
        return out

    @cached_property
    def stair(self) -> float:
        """The even step between the levels at which the drive mostly rests [drive unit]; 0.0 else.

        At rest is what stood for two samples, mostly half of all.
        """
        rests = self.stands & np.append(False, self.stands[:-1])
        step = quantum_of(self.drive[rests]) if np.mean(self.stands) >= MOSTLY else 0.0
        return step if np.ptp(self.drive) > (FEWEST_STAIRS - 0.5) * step else 0.0

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

"""Rows to fit on in place of all samples: means over blocks of them, or some that were picked."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from pipeline.physics.mechanism import Mechanism, Trace
from pipeline.physics.motion import Motion
from pipeline.physics.piece import Piece

MOST_KEPT = 500


@dataclass(frozen=True)
class Averaged:
    """Rows that are means over blocks of `size` samples of a motion.

    begins: (rows,) the first sample of each block. A mechanism works on every sample; its answers
    are averaged like the measurement: over samples that are known, a mask (n,), where at least half
    of a block are. What a piece adds does not depend on the others unless one changes the sum: then
    its means are kept.
    """

    motion: Motion
    size: int
    begins: np.ndarray
    known: np.ndarray | None = None
    kept: dict[tuple[str, str, bytes], np.ndarray] = field(default_factory=dict)

    def mean(self, values: np.ndarray) -> np.ndarray:
        """Block means of samples (n,); NaN where one is that counts."""
        blocks = values[self.samples]
        sums = np.einsum("ij,ij->i", blocks, self.counts)
        if np.isnan(sums).any():
            counted = np.where(self.counts > 0.0, blocks, 0.0)
            sums = np.einsum("ij,ij->i", counted, self.counts)
        return np.asarray(sums / self.counted)

    @cached_property
    def samples(self) -> np.ndarray:
        """Which samples each block has, (rows, size)."""
        return self.begins[:, None] + np.arange(self.size)

    @cached_property
    def counts(self) -> np.ndarray:
        """1 of each sample that counts in the mean of its block, 0 of others, (rows, size)."""
        if self.known is None:
            return np.ones(self.samples.shape)
        known = self.known[self.samples]
        few = 2 * known.sum(axis=1, keepdims=True) < self.size
        return np.where(known | few, 1.0, 0.0)

    @cached_property
    def counted(self) -> np.ndarray:
        """How many samples count in each block, (rows,)."""
        return np.asarray(self.counts.sum(axis=1))

    def trace(self, mechanism: Mechanism) -> Trace:
        """The block means of what a mechanism does."""
        if all(piece.term.adds for piece in mechanism.pieces):
            simulated = self._added(None)
            added = sum((self._added(piece) for piece in mechanism.pieces), 0.0 * simulated)
            return Trace(simulated, simulated, simulated + added, {}, added)
        trace = mechanism.trace(self.motion)
        changed = None if trace.added is None else self.mean(trace.added)
        asked, body, seen = (self.mean(x) for x in (trace.asked, trace.body, trace.seen))
        return Trace(asked, body, seen, trace.state, changed)

    def _added(self, piece: Piece | None) -> np.ndarray:
        """Means of what a piece adds, (rows,); of the simulated force for None."""
        term, values = (None, np.zeros(0)) if piece is None else (piece.term, piece.values)
        key = ("", "", b"") if term is None else (term.name, term.form, values.tobytes())
        if key not in self.kept:
            if len(self.kept) > MOST_KEPT:
                self.kept.clear()
            if piece is None:
                self.kept[key] = self.mean(Mechanism().trace(self.motion).seen)
            else:
                added = Mechanism(pieces=(piece,)).trace(self.motion).added
                assert added is not None
                self.kept[key] = self.mean(added)
        return self.kept[key]


def one_after_another(count: int, size: int) -> np.ndarray:
    """The first sample of each block of `size`, (rows,); the last few of `count` have no block."""
    return np.arange(0, count // size * size, size)


def averaged_evenly(motion: Motion, size: int) -> Averaged:
    """Rows that are means over blocks of `size` samples one after another, all of them known."""
    return Averaged(motion, size, one_after_another(len(motion), size))


@dataclass(frozen=True)
class Picked:
    """Rows (indices) that were picked of a motion's samples.

    Terms that go by time answer on every sample: between picked rows the command is not held.
    turned: samples (indices) at which a command stands out between two of them. Where there are
    any, all terms answer on them too: what remembers travel has been there.
    """

    motion: Motion
    rows: np.ndarray
    turned: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=int))

    def behind(self, pieces: Sequence[Piece]) -> "Picked | None":
        """The samples on which pieces have to answer; None where the picked rows say it all."""
        if any(piece.term.timed for piece in pieces):
            return self
        return self.travelled if len(self.turned) else None

    @cached_property
    def travelled(self) -> "Picked":
        """The picked rows of those samples alone that tell where the commands have been."""
        kept = np.union1d(self.rows, self.turned)
        return Picked(self.motion.rows(kept), np.searchsorted(kept, self.rows))

    def trace(self, mechanism: Mechanism) -> Trace:
        """What a mechanism does in the picked rows."""
        return mechanism.trace(self.motion).rows(self.rows)


def turned_between(motion: Motion, rows: np.ndarray, least: float) -> np.ndarray:
    """Samples between picked rows (indices, rising) that a memory of travel needs, as indices.

    Where one stands out beyond the rows before and after it by more than `least` of the range of a
    command: the farthest to each side. What turns before an extreme leaves no trace after it (the
    wiping-out property, Mayergoyz, Phys. Rev. Lett. 56 (1986) 1518); smaller turns after the last
    one do, and are left out.
    """
    found: set[int] = set()
    for signal in (motion.drive, *motion.others.values()):
        for values in (signal, -signal):
            ends = np.maximum(values[rows[:-1]], values[rows[1:]])
            highest = np.maximum.reduceat(values, rows)[:-1] if len(rows) > 1 else ends
            for gap in np.flatnonzero(highest > ends + least * np.ptp(signal)):
                first, last = rows[gap], rows[gap + 1]
                found.add(int(first + np.argmax(values[first:last])))
    return np.array(sorted(found), dtype=int)

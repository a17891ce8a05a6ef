"""More or less of what a simulation itself has: its play, its friction, its lag, its creep."""

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from pipeline.number_words import worded
from pipeline.physics.creep import Creep
from pipeline.physics.drive_play import DrivePlay
from pipeline.physics.friction import Friction
from pipeline.physics.motion import Motion
from pipeline.physics.piece import Piece
from pipeline.physics.response_lag import LOADED, ResponseLag
from pipeline.physics.second_order_lag import SecondOrderLag
from pipeline.physics.slip_spectrum import SlipSpectrum, elements_of
from pipeline.physics.term import Parameter, Surroundings, Term

OWN, AS_STIFF = "own", "own as stiff"
MOST, LEAST = 2.0, 1e-3
NOTHING = (0.0, "")
STARTS = (-0.6, -0.2, 0.3, 1.0)


def amount_of(piece: Piece) -> float:
    """How much a simulation has of something: a width, a time constant [s], a share."""
    if isinstance(piece.term, SlipSpectrum):
        return float(2.0 * elements_of(piece.values)[1].sum())
    if isinstance(piece.term, SecondOrderLag):
        frequency, damping = piece.values[:2]
        return float(2.0 * damping / frequency)
    return float(piece.values[0])


def own_amounts(own: Iterable[Piece], around: Surroundings) -> dict[str, tuple[float, str]]:
    """How much a simulation has of each name, with its unit."""
    return {p.term.name: (amount_of(p), unit_of(p, around)) for p in own}


def unit_of(piece: Piece, around: Surroundings) -> str:
    """The unit of that amount."""
    return "s" if isinstance(piece.term, SecondOrderLag) else piece.term.parameters(around)[0].unit


def times(piece: Piece, factor: float, as_stiff: bool) -> Piece:
    """A piece with that much more or less of it (factor >= 0), its form the same.

    as_stiff: whether friction gives way over that much more or less, too.
    """
    values = piece.values.copy()
    if isinstance(piece.term, SlipSpectrum):
        values[2:] *= factor
        values[:2] *= max(factor, LEAST) if as_stiff else 1.0
    elif isinstance(piece.term, Friction):
        values[0] *= factor
        values[1] *= max(factor, LEAST) if as_stiff else 1.0
    elif isinstance(piece.term, SecondOrderLag):
        values[0] /= max(factor, LEAST)
    else:
        values[0] *= factor
    return replace(piece, values=values)


LOADS = {
    (Creep.name, "whole"): Creep(),
    (ResponseLag.name, "whole"): ResponseLag(),
    (ResponseLag.name, "running"): ResponseLag(LOADED),
}
"""What loads a joint as what is late behind the curve says of one without other loads."""


def as_load(piece: Piece) -> Piece | None:
    """A piece in the balance at the joint, which is as late there without other loads; or None."""
    term = LOADS.get((piece.term.name, piece.term.form))
    return None if term is None else replace(piece, term=term)


class OwnAmount(Term):
    """What the simulation itself has, wider, longer or stronger by that much; or less, below 0.

    The mechanism puts it where the simulation's own is (`Mechanism`); the law stays as that is. It
    is only where the simulation has some: `Surroundings.own`.
    """

    before_curve = True
    form = OWN
    size = "width"
    what = ""

    def amount(self, around: Surroundings) -> float:
        """How much of it the simulation has."""
        return around.own.get(self.name, NOTHING)[0]

    def unit(self, around: Surroundings) -> str:
        """Of that amount."""
        return around.own.get(self.name, NOTHING)[1]

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        own = self.amount(around)
        return (
            Parameter(self.size, self.unit(around), -own, MOST * own, STARTS[0] * own, 0.3 * own),
        )

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        return signal, np.zeros(0)

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        return self.amount(around) * np.array(STARTS)[:, None]

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        return around.drive_span > 0.0 and self.amount(around) > 0.0

    def sentence(self, values: np.ndarray, around: Surroundings) -> str:
        how, unit = "much" if values[0] < 0.0 else "little", self.unit(around)
        off, own = (f"{worded(abs(v))} {unit}".strip() for v in (values[0], self.amount(around)))
        return f"The simulation has {off} too {how} {self.what}: it has {own}."


class OwnPlay(OwnAmount):
    """Play that is wider or narrower than the simulation's."""

    name = DrivePlay.name
    site = DrivePlay.site
    remembers = "way"
    group = DrivePlay.group
    what = "play"


class OwnFriction(OwnAmount):
    """Friction that holds back more or less than the simulation's.

    It gives way over the same reach, or, in form "own as stiff", over one that goes with that: as
    of a contact that is as stiff, and pressed otherwise.
    """

    name = Friction.name
    site = Friction.site
    remembers = "way"
    what = "friction"


class OwnLag(OwnAmount):
    """A lag that is longer or shorter than the simulation's."""

    name = ResponseLag.name
    site = ResponseLag.site
    group = ResponseLag.group
    remembers = "time"
    timed = True
    size = "time_constant"
    what = "lag"


class OwnCreep(OwnAmount):
    """Creep that is more or less than the simulation's."""

    name = Creep.name
    site = Creep.site
    remembers = "time"
    timed = True
    size = "share"
    what = "creep"


OWN_AMOUNTS = OwnPlay(), OwnFriction(), OwnFriction(AS_STIFF), OwnLag(), OwnCreep()


def changed(own: Sequence[Piece], pieces: Sequence[Piece]) -> tuple[Piece, ...]:
    """What a simulation has, as much of it as pieces say."""
    more = {p.term.name: p for p in pieces if isinstance(p.term, OwnAmount)}
    return tuple(more_of(p, more[p.term.name]) if p.term.name in more else p for p in own)


def more_of(piece: Piece, more: Piece) -> Piece:
    """A piece with as much more of it as another says."""
    factor = max(1.0 + float(more.values[0]) / amount_of(piece), 0.0)
    return times(piece, factor, more.term.form == AS_STIFF)

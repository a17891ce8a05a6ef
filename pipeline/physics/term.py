"""A term: one piece of physics with named, bounded parameters that changes a signal."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import ClassVar, Literal, Protocol

import numpy as np

from pipeline.errors import LoopgapError, did_you_mean, refusal
from pipeline.number_words import worded
from pipeline.physics.motion import Motion

SITES = ("actuator", "transmission", "body", "sensor")
LAST = 1000.0
HELD = "held"
"""What a form may differ beside: a joint that a term of the balance holds."""
NO_STATE = np.zeros(0)


class TermError(LoopgapError):
    """A term was asked for with parameters that it does not have."""


@dataclass(frozen=True)
class Parameter:
    """A number with a meaning; `start` is where a search begins, `typical` a size that is usual.

    moment: it is a time and acts between two samples only, so that the answer has no slope by it
    and samples are tried; any other edge needs a width. weak: data say little of it, so that it is
    held near its start and no choice charges for it. relative: it may lie anywhere over decades, so
    that its slope is taken over a share of its value. measured: it is a size in the measurement
    itself, and is told with the calibration's gain in it. at_drive: it is a size of the drive, and
    is told, in `unit`, as what a joint of the curve's mean slope makes of it. at_home: it moves the
    joint by more where the curve is steeper, and is told as it is where the drive is at 0. place:
    it is a simulated angle, and is told as the measurement reads there, too.
    """

    name: str
    unit: str
    low: float
    high: float
    start: float
    typical: float
    moment: bool = False
    weak: bool = False
    relative: bool = False
    measured: bool = False
    at_drive: bool = False
    at_home: bool = False
    place: bool = False


@dataclass(frozen=True)
class Surroundings:
    """What a term must know of a recording to bound and start its parameters.

    drive_span, angle_span: range of the drive [drive unit] and of the simulated angle [angle unit].
    drive_low, angle_low: their lower ends. step: median step of the drive [drive unit]. spacing:
    between neighbouring positions where it was, no more than a step [drive unit].
    dwell_s: median time between samples. start_s, end_s: first and last time. cycles: how many.
    other_span, other_unit: range and unit of each other command. top_speed, top_acceleration: of
    the drive where a force is measured against it [drive unit/s, /s^2]; the angle is then the
    force, and `simulated` says whether the simulation has a force at all, `resisting` whether that
    has a part that goes by the speed, `accelerating` one that goes by the acceleration. own: how
    much a simulation itself has of a name (play, friction, a lag, creep), with its unit.
    """

    drive_span: float = 120.0
    drive_low: float = -60.0
    angle_span: float = 80.0
    angle_low: float = -40.0
    step: float = 1.2
    spacing: float = 1.2
    dwell_s: float = 3.0
    start_s: float = 0.0
    end_s: float = 5400.0
    cycles: int = 9
    travel: float = 2160.0
    drive_unit: str = "deg"
    angle_unit: str = "deg"
    other_span: Mapping[str, float] = field(default_factory=dict)
    other_unit: Mapping[str, str] = field(default_factory=dict)
    top_speed: float = 0.0
    top_acceleration: float = 0.0
    simulated: bool = False
    resisting: bool = False
    accelerating: bool = False
    own: Mapping[str, tuple[float, str]] = field(default_factory=dict)

    @property
    def period_s(self) -> float:
        """How long a cycle takes."""
        return (self.end_s - self.start_s) / max(self.cycles, 1)


class Shown(Protocol):
    """What a recording shows of the parameters of one term that was fitted to it.

    step: of the drive, where the term acts [its unit there].
    """

    @property
    def step(self) -> float: ...

    def worth(self, size: int, course: Sequence[int] = ()) -> bool:
        """Whether a parameter tells anything, with those held, and charged, that only shape it."""

    def most(self, size: int, course: Sequence[int] = ()) -> float:
        """Upper end of a parameter's 95 % interval, with those held that only shape it."""

    def sharp(self, reach: int) -> bool:
        """Whether the corners that a parameter rounds are surely sharper than a step."""


Told = Sequence[tuple["Term", np.ndarray]]


class Term:
    """One piece of physics; subclasses say what it does to a signal.

    name: the catalogue's name. form: which of several forms of it ("" where there is one).
    site: where in the chain it acts. before_curve: True where it acts on the drive, before the
    nominal curve. place: where among those before the curve, and among those after the balance:
    that of the lowest place acts first, that of `LAST` at the end. adds: whether what it adds does
    not depend on the signal. timed: whether its answer needs every sample, as what it does within a
    dwell depends on how long that is. means: what its name is in general, said once for a name.
    says: one line that a mechanic understands, with `{parameter}` fields.
    grows: for a form, those that hold more of the real thing; their first parameters are the same.
    far_apart: whether a start says little of where a fit from it ends, until it has gone some way.
    holds: whether it keeps the joint where other terms of the balance would move it.
    slow: whether it moves the zero while all else stays, as noise that wanders does.
    evolves: whether it becomes another with time or travel, each form in a course of its own.
    remembers: what of its signal it remembers: the "way" that it went, or for a "time".
    periodic: whether it comes again over the drive; its second parameter is that period.
    side: 1 or -1 for each side of what may stand on both, once on each; 0 elsewhere.
    group: of its terms only one may stand; "" where that goes by the name.
    goes_by: the other command that what bends a curve goes by, too; "" of one static curve.
    beyond: what its form says that the catalogue has no name for; "" where its name says all.
    beyond_alone: the same of a form that its name covers beside another of it, or where it ties.
    beyond_lone: the same of a form that its name covers beside any other name.
    nameless: whether no name of the catalogue is its own, and it is told in words only.
    lowers_gain: whether a robot moves less by it, so that a gain may have been fitted to that.
    unlikely: how much less likely than others it is in its form, in -2 log odds.
    apart: what tells it from another piece of its name, said behind its parameters.
    also: names that tell what this form does as well as its own; also_on_both: where it stands on
    both sides.
    mistaken_for: the name of what may be this instead, if it looks like that in disguise, or is
    behind it by no more than its charge.
    only_beside: what a form differs from its kin beside, and nowhere else: a name, a group, or
    HELD, where a term holds the joint; "" for anything.
    scanned: whether what its form has beyond a plainer one is looked for all over a grid, each
    start in the size that suits what that leaves (`resized`); what both forms have is kept.
    own_law: whether a form bends otherwise than the plainer one whose parameters it has: a fit of
    that is one more place to begin from, not the only one.
    """

    name: ClassVar[str]
    site: ClassVar[str]
    before_curve: bool = False
    place: float = LAST
    in_balance: bool = False
    holds: ClassVar[bool] = False
    slow: ClassVar[bool] = False
    evolves: bool = False
    apart: str = ""
    also: tuple[str, ...] = ()
    also_on_both: tuple[str, ...] = ()
    mistaken_for: str = ""
    unlikely: float = 0.0
    beyond: str = ""
    beyond_alone: str = ""
    beyond_lone: str = ""
    nameless: bool = False
    lowers_gain: bool = False
    goes_by: str = ""
    only_beside: str = ""
    own_law: bool = False
    scanned: bool = False
    adds: bool = False
    timed: bool = False
    far_apart: bool = False
    group: str = ""
    remembers: Literal["", "way", "time"] = ""
    periodic: ClassVar[bool] = False
    means: ClassVar[str] = ""
    says: ClassVar[str]
    form: str = ""
    grows: ClassVar[Mapping[str, tuple[str, ...]]] = {}

    def __init__(self, form: str = "") -> None:
        self.form = form or self.form

    @property
    def kin(self) -> str:
        """The form that it is much alike: both are one idea in a search."""
        return self.form

    @property
    def side(self) -> float:
        return 0.0

    @property
    def in_usual_order(self) -> str:
        """Its form with the usual order on the shaft: what differs in that alone shows at once."""
        return self.form

    @property
    def said_by_name(self) -> str:
        """The form of which its name says all, where that isn't the first one of the catalogue."""
        return ""

    def elsewhere(self) -> tuple["Term", ...]:
        """This term at its other places in the chain, its parameters the same.

        There it differs beside what each form says (`only_beside`), and nowhere else.
        """
        return ()

    @property
    def matters_to(self) -> frozenset[str]:
        """What terms that differ only beside something wait for: its name, group, HELD if it is."""
        return frozenset({self.name, self.group, HELD if self.holds else ""} - {""})

    def richer(self) -> tuple["Term", ...]:
        """This term in the forms that hold more."""
        return tuple(type(self)(form) for form in self.grows.get(self.form, ()))

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        """Names, units, bounds and starts, in the order of `values`."""
        raise NotImplementedError

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        """The changed signal, shape (n,), and the state to carry to the next block of samples.

        values: (p,) parameters in their order. state: None before the first sample.
        """
        raise NotImplementedError

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        """Parameter sets to begin a search from, shape (k, p); non-smooth terms give a grid."""
        return np.array([[p.start for p in self.parameters(around)]])

    def at_moments(self, times_s: np.ndarray, around: Surroundings) -> np.ndarray:
        """Parameter sets (k, p) of a term that acts at moments: at these, (m,) [s]."""
        return np.zeros(0)

    def scaled(self, values: np.ndarray, factor: float) -> np.ndarray:
        """Parameters of about `factor` times the effect; the first one is the size unless said."""
        out = values.copy()
        out[0] *= factor
        return out

    def resized(self, values: np.ndarray, factor: float) -> np.ndarray:
        """Parameters of about `factor` times what a scanned form has beyond a plainer one."""
        return values

    def leaps(self, motion: Motion, angle: np.ndarray, values: np.ndarray) -> np.ndarray:
        """Samples (n,) at which it leaps to another state by itself, which a fit dates to a sample.

        angle: (n,) the joint's, in balance.

        What stands off there says when it did, and not that the sample was mistaken.
        """
        return np.zeros(len(motion), dtype=bool)

    def retold(self, starts: np.ndarray) -> np.ndarray:
        """Starts (k, p) with those that tell about the same in another way, if there are any."""
        return starts

    def instead(self, values: np.ndarray, motion: Motion, around: Surroundings) -> Sequence[Told]:
        """What may stand in this one's place where no small step leads there: terms with values.

        Each is a place to begin from; of those with the same terms the best counts.
        """
        return ()

    def also_at(self, values: np.ndarray, around: Surroundings) -> tuple[str, ...]:
        """Names that tell what it does with these values as well as its own; `also` unless said."""
        return self.also

    def other_names(self, values: np.ndarray, around: Surroundings) -> tuple[str, ...]:
        """Names that no motion tells from its own, or where something else is measured."""
        return ()

    def beyond_at(self, values: np.ndarray, around: Surroundings) -> str:
        """What it says with these values that its name does not; `beyond` unless said."""
        return self.beyond

    def chance(self, values: np.ndarray, motion: Motion) -> float:
        """What it takes to be no more than a coincidence with these values, in -2 log odds."""
        return 0.0

    def void(self, values: np.ndarray) -> bool:
        """Whether this amounts to no such thing; the first parameter is the size unless said."""
        return bool(values[0] == 0.0)

    def slight(self, values: np.ndarray, around: Surroundings) -> bool:
        """Whether a plainer form tells it: what this one has beyond is too little, or another's."""
        return False

    def plainer(self, values: np.ndarray, shown: Shown) -> str:
        """The name of what this amounts to in what is shown: its own, or one that it hides."""
        return self.name

    def may_be_itself(self, values: np.ndarray, around: Surroundings, shown: Shown) -> bool:
        """Whether it may be itself where a plainer name says as much: nothing rules that out."""
        return False

    def limit(self, values: np.ndarray, around: Surroundings) -> str:
        """The name of what this comes to where it can go no further; "" where it can."""
        return ""

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        """Whether this motion could show the term at all."""
        return around.drive_span > 0.0

    def sentence(self, values: np.ndarray, around: Surroundings) -> str:
        """`says` with its numbers filled in."""
        named = {
            p.name: f"{worded(abs(v))} {p.unit}".strip()
            for p, v in zip(self.parameters(around), values, strict=True)
        }
        return self.says.format(**named)


def values_of(
    term: Term,
    around: Surroundings,
    named: Mapping[str, float],
    usual: Surroundings | None = None,
) -> np.ndarray:
    """Parameters by name as an array in the term's order; starts where none is given.

    usual: surroundings that the starts are of, where `around` is wider than the motion.
    Raises TermError for a name that the term does not have or a value outside its bounds.
    """
    parameters = term.parameters(around)
    unknown = sorted(set(named) - {p.name for p in parameters})
    if unknown:
        names = ", ".join(p.name for p in parameters)
        raise TermError(
            refusal(
                f"term {term.name!r}",
                f"parameters {names}",
                unknown[0],
                f"{did_you_mean(unknown[0], names.split(', '))}Name one of these.",
            )
        )
    starts = parameters if usual is None else term.parameters(usual)
    values = [named.get(p.name, p.start) for p in starts]
    for p, value in zip(parameters, values, strict=True):
        if not p.low <= value <= p.high:
            raise TermError(
                refusal(
                    f"term {term.name!r}, parameter {p.name!r}",
                    f"a value from {p.low:g} to {p.high:g} {p.unit}".strip(),
                    f"{value:g}",
                    "Choose one within.",
                )
            )
    return np.array(values, dtype=float)

"""Which effects a case hides, and which the simulation has itself: names that data can tell."""

import numpy as np

from pipeline.concealed.effects import CATALOGUE
from pipeline.concealed.outside import OUTSIDE

EFFECTS_OF = {"none": 0, "walk": 0, "one": 1, "two": 2, "three": 3, "small": 1}
EFFECTS_BESIDE_KNOWN = {"known_none": 0, "known_one": 1}
KINDS = (*EFFECTS_OF, "outside", *EFFECTS_BESIDE_KNOWN)
EXCITATIONS = ("plain", "rich")
KNOWN = ("backlash", "friction", "creep", "response_lag")
BENDS = frozenset({"compliance", "gravity", "camera_tilt", "lens_distortion"})
KINKS = frozenset({"slack", "contact", "end_stop"})
EXCLUSIVE = (
    BENDS | {"slack"},
    frozenset({"contact", "end_stop"}),
    frozenset({"backlash", "friction", "tension_loss"}),
    frozenset({"lost_steps", "drift"}),
    frozenset({"creep", "response_lag", "frame_lag"}),
)
EXCLUSIVE_PLAIN = (
    frozenset({"backlash", "friction", "tension_loss", "creep", "response_lag", "frame_lag"}),
)
BESIDE_OUTSIDE = 0.25
OUTSIDE_PLAIN = tuple(name for name in OUTSIDE if name != "step_resonance")


def first_names(rng: np.random.Generator, wanted: list[tuple[str, str]]) -> list[str | None]:
    """First effect of each case (kind, excitation): all names come equally often in each."""
    queues: dict[tuple[str, str], list[str]] = {}
    turns: list[str | None] = []
    for kind, excitation in wanted:
        queue = queues.setdefault((kind, excitation), [])
        if not queue:
            queue.extend(str(name) for name in rng.permutation(_names_of(kind, excitation)))
        turns.append(queue.pop() if _hides(kind) else None)
    return turns


def further_names(
    rng: np.random.Generator, kind: str, excitation: str, first: str | None
) -> list[str]:
    """The effects of a case: `first`, and others that data of this kind can tell from it."""
    if first is None:
        return []
    beside = rng.random() < BESIDE_OUTSIDE
    wanted = _hides(kind) + (kind == "outside" and beside)
    names = [first]
    for name in rng.permutation(candidates(excitation)):
        if len(names) < wanted and str(name) not in names and not clash(name, names, excitation):
            names.append(str(name))
    return names


def known_names(
    rng: np.random.Generator, kind: str, excitation: str, names: list[str]
) -> list[str]:
    """What the simulation has itself, of KNOWN, where some names are hidden."""
    if kind not in EFFECTS_BESIDE_KNOWN:
        return []
    return [str(rng.choice(_beside_which(names, excitation)))]


def candidates(excitation: str) -> list[str]:
    """Names that a motion of this kind can show."""
    names = [*CATALOGUE, "marker_outliers"]
    return [name for name in names if excitation == "rich" or name != "coupling"]


def clash(name: str, others: list[str], excitation: str) -> bool:
    """Whether data of this kind can't tell a name from one of some others."""
    groups = EXCLUSIVE + (EXCLUSIVE_PLAIN if excitation == "plain" else ())
    return any(name in group and group & set(others) for group in groups)


def _hides(kind: str) -> int:
    """How many effects a case hides; at least one outside the catalogue."""
    return 1 if kind == "outside" else {**EFFECTS_OF, **EFFECTS_BESIDE_KNOWN}[kind]


def _names_of(kind: str, excitation: str) -> list[str]:
    if kind == "outside":
        return list(OUTSIDE if excitation == "rich" else OUTSIDE_PLAIN)
    names = candidates(excitation)
    if kind in EFFECTS_BESIDE_KNOWN:
        return [n for n in names if _beside_which([n], excitation)]
    return [n for n in names if kind != "small" or n != "marker_outliers"]


def _beside_which(names: list[str], excitation: str) -> list[str]:
    """What a simulation may have itself where some names are hidden."""
    return [k for k in KNOWN if k not in names and not clash(k, names, excitation)]

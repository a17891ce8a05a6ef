"""Ties: explanations that these data can't tell from the best one, and the known equivalents."""

from dataclasses import dataclass

import numpy as np

from pipeline.discrepancy.choose import Choice
from pipeline.discrepancy.intervals import covariance_of
from pipeline.discrepancy.problem import Problem

TIE = 9.0
TEMPERATURE = 2.0
LOOP_STEPS = 4.0
BENDS = ("camera_tilt", "lens_distortion", "compliance", "gravity")
LOOPS = ("creep", "friction", "response_lag")
DELAYS = ("backlash", "frame_lag", "response_lag")
SAME_DWELL = 0.2
IN_STEP = ("inertia", "stiffness")
ALONG = 0.99


@dataclass(frozen=True)
class Standing:
    """How sure a name is: its probability, and the names that could stand in its place.

    tied: whether one of them fits as well in these data.
    """

    probability: float
    alternatives: tuple[str, ...]
    tied: bool


def weights_of(choices: list[Choice]) -> np.ndarray:
    """Probability of each choice among those found, (k,), tempered."""
    scores = np.array([c.score for c in choices])
    weights = np.exp(-0.5 * (scores - scores.min()) / TEMPERATURE)
    return weights / weights.sum()


def standing(name: str, best: Choice, choices: list[Choice], problem: Problem) -> Standing:
    """What the other choices say of a name of the best one."""
    distinct = by_names(choices)
    weights = weights_of(distinct)
    probability = float(sum(w for w, c in zip(weights, distinct, strict=True) if name in names(c)))
    rest = names(best) - {name}
    gaps: dict[str, float] = {}
    for choice in distinct:
        other = names(choice) - rest
        if rest <= names(choice) and len(other) == 1 and name not in other and grows(choice):
            gaps.setdefault(next(iter(other)), choice.score - best.score)
    tied = [n for n, gap in gaps.items() if gap < TIE]
    known = [n for n in equivalents(name, problem) if n not in names(best) | set(tied)]
    return Standing(probability, tuple(sorted(tied) + known), bool(tied))


def grows(choice: Choice) -> bool:
    """Whether a play that is said to grow does so for sure; else it is plain backlash."""
    fit = choice.fit
    at = 0
    for piece in fit.pieces:
        if piece.term.name == "tension_loss":
            place = len(fit.nuisance) + at
            return bool(piece.values[0] > 2.0 * np.sqrt(covariance_of(fit)[place, place]))
        at += len(piece.values)
    return True


def names(choice: Choice) -> frozenset[str]:
    return frozenset(choice.fit.names)


def by_names(choices: list[Choice]) -> list[Choice]:
    """The best choice of each set of names, in their order."""
    found: dict[frozenset[str], Choice] = {}
    for choice in sorted(choices, key=lambda c: c.score):
        found.setdefault(names(choice), choice)
    return list(found.values())


def equivalents(name: str, problem: Problem) -> list[str]:
    """Names that are known to give the same data as `name` under such commands.

    What bends one static curve is one family in any data; loops that come from lateness need
    different dwells to be told from friction, and a delay needs different steps to be told from
    play.
    """
    out: list[str] = []
    if problem.motion.kinetics is not None:
        return [n for n in IN_STEP if name in IN_STEP and n != name and in_step(problem)]
    if name in BENDS:
        out += [n for n in BENDS if n != name]
    if not dwell_varies(problem):
        if name in LOOPS:
            out += [n for n in LOOPS[:2] if n != name]
        if name in DELAYS and not step_varies(problem):
            out += [n for n in DELAYS[:2] if n != name]
    return out


def in_step(problem: Problem) -> bool:
    """Whether acceleration follows position, as at one frequency: a mass is a negative spring."""
    kinetics = problem.motion.kinetics
    if kinetics is None:
        return False
    rows = problem.train
    along = np.corrcoef(problem.motion.drive[rows], kinetics.acceleration[rows])[0, 1]
    return bool(abs(along) > ALONG)


def dwell_varies(problem: Problem) -> bool:
    """Whether some training rows were waited for much longer or shorter than others."""
    dwell = np.diff(problem.motion.time_s)[problem.train[1:]]
    middle = float(np.median(dwell)) if len(dwell) else 0.0
    return bool(np.mean(np.abs(dwell - middle) > SAME_DWELL * middle) > 0.02)


def step_varies(problem: Problem) -> bool:
    """Whether the drive moved by clearly different steps in the training rows."""
    step = np.abs(np.diff(problem.motion.drive))[problem.train[1:]]
    middle = float(np.median(step)) if len(step) else 0.0
    return bool(np.mean(np.abs(step - middle) > SAME_DWELL * middle) > 0.05)

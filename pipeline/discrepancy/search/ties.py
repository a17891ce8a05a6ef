"""Ties: explanations that these data can't tell from the best one, and the known equivalents."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pipeline.discrepancy.fitting.charge import independent
from pipeline.discrepancy.fitting.fit import Fit, evaluate, parameters_of
from pipeline.discrepancy.model.intervals import covariance_of
from pipeline.discrepancy.problem.problem import Problem
from pipeline.discrepancy.search.choose import Choice
from pipeline.physics.backlash import Backlash
from pipeline.physics.catalogue import terms
from pipeline.physics.compliance import OFF_HOME, Compliance
from pipeline.physics.contact import Contact
from pipeline.physics.friction import Friction
from pipeline.physics.mechanism import Piece
from pipeline.physics.term import Term
from pipeline.recording import reversals_of

TIE = 9.0
RIVAL_GAP = 14.0
SURE = 2.0
NEGLIGIBLE = 1e-4
DISGUISES = {
    "tension_loss": "backlash",
    "friction": "backlash",
    "slack": "compliance",
    "compliance": "slack",
}
LOOSENING = ("wire", OFF_HOME)
SHAPES = 2
TEMPERATURE = 2.0
BENDS = frozenset({"camera_tilt", "lens_distortion", "compliance", "gravity"})
SAME_AT_ONE_DWELL = (frozenset({"creep", "response_lag"}),)
SAME_AT_ONE_SPEED = (
    frozenset({"friction", "creep", "response_lag"}),
    frozenset({"backlash", "frame_lag", "response_lag"}),
)
DIFFERENT = 0.2
FEW = 0.02
SMALL = 0.25
IN_STEP = ("inertia", "stiffness")
ALONG = 0.99


@dataclass(frozen=True)
class Standing:
    """How sure a name is: its probability, and the names that could stand in its place.

    tied: whether one of them fits as well in these data, or would in any (what bends one curve).
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
    """What the other choices say of a name of the best one; one in disguise may be that other.

    Those that are the best one in disguise say nothing, but for slack that may be what bends, and
    for friction sharper than a step: it may be what looks like play, though charged for parameters
    that tell nothing there, and ties with it if it fits better. Where one bend of a static curve
    could stand in its place, each could.
    """
    distinct = by_names(choices)
    weights = weights_of(distinct)
    likely = [(w, c) for w, c in zip(weights, distinct, strict=True) if w > NEGLIGIBLE]
    shown = plain if name in plain(best) else names
    probability = float(sum(w for w, c in likely if name in shown(c)))
    hidden = DISGUISES[name] if name not in plain(best) else name
    gaps = {} if hidden in names(best) else {hidden: 0.0}
    sharper: list[str] = []
    for choice in distinct:
        other = names(choice) - names(best)
        swapped = name not in names(choice) and len(names(choice)) == len(names(best))
        gap = choice.score - best.score
        if swapped and (name in BENDS or as_itself(choice, best)):
            for one in other:
                gaps.setdefault(one, gap)
        elif swapped and name == Backlash.name and other == {Friction.name} and gap < RIVAL_GAP:
            sharper = [Friction.name]
            gaps |= {Friction.name: gap} if gap < 0.0 else {}
    tied = [n for n, gap in gaps.items() if gap < TIE]
    alike = [n for one in (name, *(BENDS & set(tied))) for n in equivalents(one, problem)]
    like = dict.fromkeys([*sharper, *sorted(alike)])
    known = [n for n in like if n not in names(best) | set(tied)]
    unsettled = bool(tied) or bool(name in BENDS and known)
    return Standing(probability, tuple(sorted(tied) + known), unsettled)


def plain(choice: Choice) -> frozenset[str]:
    """The names of a choice, each that is another one in disguise under that other name.

    A play whose growth is not worth a parameter, or whose corners are surely sharp, is backlash; a
    dead zone whose width is not worth one is wire that gives way at first, and wire that gives way
    within less than a step and no more hung slack, but not a toe, which hardens on the way. Whether
    growth is worth a parameter is asked with the shape of its course held, and that charged for,
    too: of a growth that is none nothing can be learnt of its course (Davies, Biometrika 64 (1977)
    247), and with both free a growth that is surely there looks as if it might not be.
    """
    return frozenset(plainly(choice.fit))


def as_itself(choice: Choice, best: Choice) -> bool:
    """Whether a choice is no other one in disguise, as a contact as stiff as can be is a stop."""
    stop = "end_stop" in names(best) and any(
        isinstance(p.term, Contact) and p.term.stiffest(p.values) for p in choice.fit.pieces
    )
    return plain(choice) == names(choice) and not stop


def plainly(fit: Fit) -> list[str]:
    """The same of each piece of a fit."""
    found, k = [], len(fit.nuisance)
    for i, piece in enumerate(fit.pieces):
        name, hidden = piece.term.name, False
        if name in ("tension_loss", "slack"):
            last = k + len(piece.values) if name == "tension_loss" else k + SHAPES
            shape = np.arange(k + SHAPES, last)
            worth = (1 + len(shape)) * np.log(independent(fit.ground))
            size = variance_given(covariance_of(fit), k, shape)
            hidden = bool(piece.values[0] ** 2 <= worth * size)
        elif isinstance(piece.term, Friction):
            hidden = sharp(fit, i)
        elif isinstance(piece.term, Compliance) and piece.term.form in LOOSENING:
            reach, stretch, stiffness = piece.values[1:4]
            step = where_acting(fit.ground.problem.around.step, fit, piece.term)
            hidden = bool(reach * stiffness / (stiffness + stretch) < step)
        found.append(DISGUISES[name] if hidden else name)
        k += len(piece.values)
    return found


def variance_given(covariance: np.ndarray, at: int, known: np.ndarray) -> float:
    """Variance of one parameter (m, m) where others (their places) are known, of a Gaussian."""
    deviations = np.sqrt(np.maximum(np.diag(covariance), 1e-300))
    correlation = covariance / np.outer(deviations, deviations)
    along = correlation[at, known]
    told = along @ np.linalg.pinv(correlation[np.ix_(known, known)], hermitian=True) @ along
    return float(covariance[at, at] * max(1.0 - told, 0.0))


def undisguised(choices: Sequence[Choice]) -> Choice:
    """The best of some choices, or the best of what it is in disguise."""
    best = choices[0]
    wanted = plain(best)
    same = [c for c in choices if names(c) == wanted and c.score < best.score + RIVAL_GAP]
    return min(same, key=lambda c: c.score, default=best)


def sharp(fit: Fit, place: int) -> bool:
    """Whether the corners of a friction (the fit's piece there) are surely sharper than a step.

    A step is what a quarter of the turns begin with no more than. Or sharper than two, of which one
    sample sees the inside, where they may be as sharp as can be. But turns with finer steps may
    show that corners within a step are rounded.
    """
    piece = fit.pieces[place]
    step = where_acting(first_step(fit.ground.problem.motion.drive), fit, piece.term)
    parameters = parameters_of(fit.ground, piece.term)
    reach = [p.name for p in parameters].index("reach")

    def costs(other: float) -> float:
        values = piece.values.copy()
        values[reach] = other
        pieces = (*fit.pieces[:place], Piece(piece.term, values), *fit.pieces[place + 1 :])
        return evaluate(fit.ground, pieces).cost - fit.cost

    if 2.0 * step <= piece.values[reach] or costs(2.0 * step) <= SURE**2:
        return False
    within = step > piece.values[reach] and costs(step) > SURE**2
    return costs(parameters[reach].low) <= (TIE if within else SURE**2)


def first_step(drive: np.ndarray) -> float:
    """A step that a quarter of the turns of a drive (n,) begin with no more than; 0 without any.

    Where it goes round a bend slowly, or by steps of any size, it shows more of a corner than its
    usual step would.
    """
    steps = np.abs(np.diff(drive))
    moves = np.flatnonzero(steps)
    turns = reversals_of(drive)
    first = np.searchsorted(moves, turns)
    first = first[first < len(moves)]
    return float(np.quantile(steps[moves[first]], SMALL)) if len(first) else 0.0


def where_acting(step: float, fit: Fit, term: Term) -> float:
    """A step of the drive where a term acts, before the nominal curve or behind it."""
    around = fit.ground.problem.around
    slope = around.angle_span / max(around.drive_span, 1e-300)
    return step if term.before_curve else step * slope


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

    What bends one static curve is one family in any data. Creep and lags remember time, friction
    and play remember travel: at one dwell and one step these are the same.
    """
    if problem.motion.kinetics is not None:
        return [n for n in IN_STEP if name in IN_STEP and n != name and in_step(problem)]
    families = [BENDS]
    if other_dwells(problem) <= FEW:
        families += SAME_AT_ONE_DWELL
        families += SAME_AT_ONE_SPEED if other_steps(problem) <= FEW else ()
    shown = {t.name for t in terms() if t.excited(problem.motion, problem.around)}
    return sorted({n for family in families if name in family for n in family & shown} - {name})


def in_step(problem: Problem) -> bool:
    """Whether acceleration follows position, as at one frequency: a mass is a negative spring.

    Jolts, as between two sines, do not count.
    """
    kinetics = problem.motion.kinetics
    if kinetics is None:
        return False
    rows = problem.train & (np.abs(kinetics.acceleration) <= problem.around.top_acceleration)
    along = np.corrcoef(problem.motion.drive[rows], kinetics.acceleration[rows])[0, 1]
    return bool(abs(along) > ALONG)


def other_dwells(problem: Problem) -> float:
    """Share of the training rows whose command had been held much longer or shorter than usual."""
    time_s, moved = problem.motion.time_s, ~problem.motion.stands
    last = np.flatnonzero(moved)[np.cumsum(moved) - 1]
    held_s = time_s - time_s[np.maximum(last - 1, 0)]
    return _unusual(held_s[1:][problem.train[1:]])


def other_steps(problem: Problem) -> float:
    """Share of the training rows to which the drive moved by another step than usual."""
    return _unusual(np.abs(np.diff(problem.motion.drive))[problem.train[1:]])


def _unusual(sizes: np.ndarray) -> float:
    middle = float(np.median(sizes)) if len(sizes) else 0.0
    return float(np.mean(np.abs(sizes - middle) > DIFFERENT * middle)) if len(sizes) else 0.0

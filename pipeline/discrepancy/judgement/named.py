"""The names of a diagnosis: of its terms, and of what no term of a search can show."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from pipeline.discrepancy.fitting.fit import evaluate, improve
from pipeline.discrepancy.judgement.by_direction import by_direction, said_of_ways
from pipeline.discrepancy.judgement.cycle_zero import zero_of_each_cycle
from pipeline.discrepancy.judgement.first_slip import is_start
from pipeline.discrepancy.judgement.mistaken import (
    late_now_and_then,
    mistaken_frames,
    stale_now_and_then,
)
from pipeline.discrepancy.judgement.mistaken_samples import mistaken_samples
from pipeline.discrepancy.judgement.rivals import mechanism_of
from pipeline.discrepancy.judgement.structure import RINGS, Structure
from pipeline.discrepancy.judgement.walking_zero import zero_that_walks
from pipeline.discrepancy.model.intervals import MEASURED, estimates, stated
from pipeline.discrepancy.model.result import FOLLOWS, Estimate, Evidence, NamedPhysics
from pipeline.discrepancy.search.explain import Explanation
from pipeline.discrepancy.search.ties import standing
from pipeline.discrepancy.search.weighing import Choice
from pipeline.number_words import worded
from pipeline.physics.force_term import ForceTerm
from pipeline.physics.own_amount import OwnAmount
from pipeline.physics.piece import Piece

SUREST = 0.98
SURPLUS = " The simulation has that much too much of it."


def named_physics(
    explanation: Explanation,
    best: Choice,
    evidence: Evidence,
    structure: Structure,
    covariance: np.ndarray,
) -> tuple[NamedPhysics, ...]:
    """Every term of the best choice, and what the sensor or each cycle's zero does beside them."""
    out: dict[str, NamedPhysics] = {}
    for found in of_terms(explanation, best, evidence, structure, covariance):
        before = out.get(found.name)
        out[found.name] = found if before is None else together(before, found)
    problem = explanation.problem
    beside = [stale_now_and_then(problem, evidence)]
    if problem.motion.kinetics is not None:
        beside.append(mistaken_samples(evidence, problem.around.angle_unit))
    else:
        told = {*out, *(b.name for b in beside if b is not None)}
        if not structure.found:
            beside.append(zero_of_each_cycle(problem, best, evidence))
            beside.append(zero_that_walks(explanation, best, evidence))
            beside.append(late_now_and_then(explanation, evidence))
        if out or not structure.found:
            unexplained = structure.found or structure.where == RINGS
            beside.append(mistaken_frames(explanation, evidence, told, unexplained))
    for own in beside:
        if own is not None:
            out.setdefault(own.name, own)
    return tuple(out.values())


def of_terms(
    explanation: Explanation,
    best: Choice,
    evidence: Evidence,
    structure: Structure,
    covariance: np.ndarray,
) -> Iterator[NamedPhysics]:
    """What each piece of the best choice is: half as probable where a rest is left unexplained.

    Not how a wire lay at the start, nor what has no name. What says more than its name is like no
    other name.
    """
    problem, fit = explanation.problem, best.fit
    mopping = structure.found and problem.motion.kinetics is None
    for piece, own in estimates(fit, covariance):
        name = piece.term.name
        if is_start(fit, piece) or piece.term.nameless:
            continue
        stands = standing(name, best, explanation.choices, problem)
        if piece.term.apart and fit.names.count(name) > 1:
            own = tuple(replace(e, name=f"{e.name} {piece.term.apart}") for e in own)
        ways = by_direction(best, piece, explanation.search.family)
        says = piece.term.sentence(stated(fit, piece), problem.around)
        yield NamedPhysics(
            name=name,
            site=piece.term.site,
            probability=min(stands.probability * (0.5 if mopping else 1.0), SUREST),
            parameters=(*own, *ways),
            heldout_rmse_without=error_without(best, name, evidence),
            alternatives=() if piece.term.beyond else stands.alternatives,
            says=says + said_of_surplus(piece) + said_of_ways(piece, ways) + said_as_measured(own),
            surplus=is_surplus(piece),
        )


def without_name(best: Choice) -> list[str]:
    """What the corrected simulation follows that has no name, in words."""
    around = best.fit.ground.problem.around
    nameless = [p for p in best.fit.pieces if p.term.nameless]
    return [f"{FOLLOWS}: {p.term.sentence(stated(best.fit, p), around)}" for p in nameless]


def said_of_surplus(piece: Piece) -> str:
    """That the simulation has too much of a force; "" elsewhere."""
    return SURPLUS if isinstance(piece.term, ForceTerm) and is_surplus(piece) else ""


def is_surplus(piece: Piece) -> bool:
    """Whether the simulation has too much of it: of a force, or its own, of a negative size."""
    return isinstance(piece.term, ForceTerm | OwnAmount) and bool(piece.values[0] < 0.0)


def said_as_measured(own: Sequence[Estimate]) -> str:
    """What the measurement reads where something is met in the simulation; "" where it is not."""
    read = [e for e in own if e.name.endswith(MEASURED)]
    return "".join(f" The measurement reads {worded(e.value)} {e.unit} there." for e in read)


def together(one: NamedPhysics, other: NamedPhysics) -> NamedPhysics:
    """Two pieces of one name, as its two sides are."""
    parameters = (*one.parameters, *other.parameters)
    return replace(one, parameters=parameters, says=f"{one.says} {other.says}")


def error_without(best: Choice, name: str, evidence: Evidence) -> float:
    """Held-out error of the refitted rest when a name is taken out."""
    fit = improve(evaluate(best.fit.ground, best.fit.but_for(name)))
    mechanism = mechanism_of(fit.ground.problem, Choice(fit, best.place, 0.0))
    return evidence.errors(mechanism.respond(evidence.motion)[0]).heldout_rmse


def verdict_of(
    explanation: Explanation,
    best: Choice,
    physics: Sequence[NamedPhysics],
    structure: Structure,
) -> str:
    """One of the contract's verdicts."""
    if structure.found:
        return "partly_explained" if physics else "unknown_physics"
    if not physics:
        return "no_mismatch"
    unsettled = any(_unsettled(p, explanation, best) for p in physics)
    return "ambiguous" if unsettled else "explained"


def _unsettled(physics: NamedPhysics, explanation: Explanation, best: Choice) -> bool:
    """Whether a name has others in its place that these data can't tell from it."""
    if physics.name not in best.fit.names:
        return bool(physics.alternatives)
    return standing(physics.name, best, explanation.choices, explanation.problem).tied

"""What stays of the best choice, and which structured rest is left: the fit, then the proof."""

from dataclasses import dataclass, replace

import numpy as np

from pipeline.discrepancy.fitting.charge import absurd_calibration
from pipeline.discrepancy.judgement.borne_out import borne_out
from pipeline.discrepancy.judgement.cancelling import CANCELLED, cancelling
from pipeline.discrepancy.judgement.cycle_zero import about_each_zero
from pipeline.discrepancy.judgement.form import one_for_many
from pipeline.discrepancy.judgement.gradual import unless_gradual
from pipeline.discrepancy.judgement.proof import counted_errors, disproved, refuted, strained
from pipeline.discrepancy.judgement.rivals import predicted_by
from pipeline.discrepancy.judgement.smooth_wander import (
    Beside,
    smoother_than_a_walk,
    swing_of,
    wandering,
)
from pipeline.discrepancy.judgement.structure import (
    Structure,
    mismatch_variance,
    ringing,
    share_left,
    structure_of,
    unless_many_aside,
)
from pipeline.discrepancy.judgement.verdict import (
    beside_a_rest,
    earning,
    fewer,
    follows,
    leaves_much,
    sure_of_slow,
    told_but_for_its_form,
    unless_nothing,
)
from pipeline.discrepancy.judgement.walking_zero import far_walk, walks_far
from pipeline.discrepancy.problem.problem import Problem
from pipeline.discrepancy.search.accuracy import (
    calibrated_alone,
    centred,
    evenly_calibrated,
    within_accuracy,
)
from pipeline.discrepancy.search.disguise import undisguised
from pipeline.discrepancy.search.explain import Explanation
from pipeline.discrepancy.search.foretold import foretold_part, testable
from pipeline.discrepancy.search.weighing import Choice, names, piled
from pipeline.physics.drift import Drift

SMOOTHLY = "slow changes, smoother than noise, which are no wander of the zero"


@dataclass(frozen=True)
class Decision:
    """What stays of an explanation's best choice and the structured rest.

    accurate: whether the simulation's declared accuracy decided. wander: the zero that wanders
    smoothly, where that is all the rest; the explanation is the one beside it then. modelled: the
    choice that the corrected simulation follows, where another one tells the names. refuted: names
    that the rows fitted seem to show, but held-out ones do not bear out.
    """

    explanation: Explanation
    choice: Choice
    structure: Structure
    accurate: bool = False
    wander: Beside | None = None
    modelled: Choice | None = None
    refuted: frozenset[str] = frozenset()


def decided(problem: Problem, explanation: Explanation) -> Decision:
    """What stays of the best choice, and what rest."""
    best = sure_of_slow(explanation, undisguised(explanation.choices))
    best = unless_nothing(explanation, one_for_many(explanation, best))
    borne = borne_out(problem, explanation, unless_gradual(problem, explanation, best))
    refuted = names(best) - names(borne)
    if refuted:
        kept = [c for c in explanation.choices if c is not borne and not names(c) & refuted]
        explanation = replace(explanation, choices=[borne, *kept])
    decision = decided_on(problem, explanation, borne)
    structure = unless_many_aside(decision.explanation, decision.structure)
    return replace(decision, structure=structure, refuted=refuted)


def decided_on(problem: Problem, explanation: Explanation, best: Choice) -> Decision:
    """What stays of a choice, and what rest."""
    structure = structure_of(explanation, best)
    base = next(c for c in explanation.choices if not c.fit.pieces)
    if within_accuracy(base, explanation.used):
        alone = calibrated_alone(base, explanation.used)
        none = Structure(False, None, structure.share, structure.p_value)
        return Decision(explanation, alone, none, accurate=True)
    absurd = absurd_calibration(best.fit)
    lost, undone = not follows(explanation, best), cancelling(best)
    if lost:
        structure, best = replace(structure, found=True, where="everywhere"), base
    elif undone:
        structure, best = replace(structure, found=True, where=CANCELLED), base
    elif absurd is not None:
        structure = replace(structure, found=True, where=absurd)
    told, known = best, absurd is None
    best, structure = proved(problem, explanation, best, structure, known)
    smooth = moves_smoothly(explanation, best)
    if not (structure.found or smooth or unsure_walk(explanation, told, best)):
        return Decision(explanation, best, structure)
    sound = known and not (lost or undone or ringing(explanation, told))
    wandered = beside_a_wander(problem, explanation, told) if sound else None
    if wandered is not None and wandered.wander is not None:
        swing = swing_of(wandered.wander)
        if swing is None:
            return wandered
        structure = replace(structure, found=True, where=swing)
    if smooth and not structure.found:
        structure = replace(structure, found=True, where=SMOOTHLY)
        if best.fit.pieces:
            rest = share_left(explanation, best) * mismatch_variance(explanation)
            best = beside_a_rest(explanation, best, rest)
    if not structure.found:
        return Decision(explanation, best, structure)
    share = max(structure.share, share_left(explanation, best))
    best = best if best.fit.pieces else evenly_calibrated(best, explanation.used)
    return Decision(explanation, best, replace(structure, share=share))


def proved(
    problem: Problem, explanation: Explanation, best: Choice, structure: Structure, sound: bool
) -> tuple[Choice, Structure]:
    """What stays of the best choice, and what rest held-out rows leave to it.

    sound: whether the calibration is one.
    """
    judge = without_repeats if unrepeated(explanation, best) else by_repeats
    best, structure = judge(problem, explanation, best, structure, sound)
    if structure.found:
        return best, structure
    off, counted = counted_errors(problem, explanation, best, predicted_by(problem, best))
    farthest = np.inf if walks_far(explanation, best) else far_walk(best)
    where = strained(problem, off, counted, best.fit.ground.noise, farthest)
    return best, replace(structure, found=where is not None, where=where or structure.where)


def unrepeated(explanation: Explanation, choice: Choice) -> bool:
    """Whether no cycle repeats another, and a choice can be tested without that."""
    angle = explanation.problem.derivatives is None
    return explanation.prior.repeats == 0 and angle and testable(choice)


def unsure_walk(explanation: Explanation, told: Choice, best: Choice) -> bool:
    """Whether the zero of what stays walks, of one that was told where no cycle repeats another.

    Of one without names only if it is smoother than a walk: that alone is no mismatch.
    """
    if not (unrepeated(explanation, told) and best.fit.ground.noise.walk > 0.0):
        return False
    return bool(told.fit.pieces) or smoother_than_a_walk(best)


def moves_smoothly(explanation: Explanation, choice: Choice) -> bool:
    """Whether what a choice leaves moves smoothly, as cycles that repeat make sure."""
    angle = explanation.problem.derivatives is None
    return explanation.prior.repeats > 0 and angle and smoother_than_a_walk(choice)


def beside_a_wander(problem: Problem, explanation: Explanation, best: Choice) -> Decision | None:
    """The decision where all that is left is a zero that wanders smoothly, also in held-out rows.

    In each cycle it begins somewhere else. A course of it that was found stays in the model.
    """
    found = wandering(explanation, best)
    if found is None:
        return None
    explanation, beside = found
    choice = explanation.choices[0]
    off, counted = counted_errors(problem, explanation, choice, predicted_by(problem, choice))
    off = about_each_zero(off, problem.cycle, counted & np.isfinite(off))
    if refuted(problem, off, counted):
        return None
    modelled = best if names(best) - names(choice) == {Drift.name} else None
    none = Structure(False, None, 0.0, 1.0)
    told = centred(choice, explanation.used)
    return Decision(explanation, told, none, wander=beside, modelled=modelled)


def by_repeats(
    problem: Problem, explanation: Explanation, best: Choice, structure: Structure, sound: bool
) -> tuple[Choice, Structure]:
    """What stays where repeats say what noise is: beside a rest only names that it leaves sure.

    sound: whether the calibration is one; then a small rest is the form of what stays.
    """
    if not structure.found:
        structure = disproved(problem, explanation, best, predicted_by(problem, best), structure)
    if not structure.found:
        return best, structure
    kept = fewer(explanation, best, structure)
    return kept, told_but_for_its_form(explanation, kept, structure) if sound else structure


def without_repeats(
    problem: Problem, explanation: Explanation, best: Choice, structure: Structure, sound: bool
) -> tuple[Choice, Structure]:
    """What stays where nothing says what noise is: beside a rest only what foretells later rows.

    A small rest is the form of the names before any of them goes; held-out rows that refute the
    names as they are do so whatever is left. As many names as a search takes that leave a rest
    foretell later rows, too: they follow the shape of something else, and so do several names that
    leave much of the mismatch. Of others each has to explain twice what they leave.
    """
    if structure.found and sound:
        structure = told_but_for_its_form(explanation, best, structure)
    if not structure.found:
        structure = disproved(problem, explanation, best, predicted_by(problem, best), structure)
        if structure.wandering is not None:
            structure = told_but_for_its_form(explanation, best, structure)
    if not structure.found:
        return best, structure
    rest = structure.share * mismatch_variance(explanation)
    kept = foretold_part(explanation.choices, best, rest)
    mops_up = piled(kept) or leaves_much(explanation, kept)
    earns = beside_a_rest if mops_up else earning
    return earns(explanation, kept, rest), structure

"""What stays of the best choice, and which structured rest is left: the fit, then the proof."""

from dataclasses import replace

import numpy as np

from pipeline.discrepancy.fitting.charge import absurd_calibration
from pipeline.discrepancy.judgement.cancelling import CANCELLED, cancelling
from pipeline.discrepancy.judgement.form import one_for_many
from pipeline.discrepancy.judgement.proof import counted_errors, disproved, strained
from pipeline.discrepancy.judgement.rivals import mechanism_of
from pipeline.discrepancy.judgement.structure import (
    Structure,
    mismatch_variance,
    share_left,
    structure_of,
)
from pipeline.discrepancy.judgement.verdict import (
    fewer,
    follows,
    sure_of_slow,
    told_but_for_its_form,
    unless_nothing,
)
from pipeline.discrepancy.judgement.walking_zero import walks_far
from pipeline.discrepancy.problem.problem import Problem
from pipeline.discrepancy.search.accuracy import (
    calibrated_alone,
    evenly_calibrated,
    within_accuracy,
)
from pipeline.discrepancy.search.disguise import undisguised
from pipeline.discrepancy.search.explain import Explanation
from pipeline.discrepancy.search.foretold import foretold_part, testable
from pipeline.discrepancy.search.weighing import Choice


def decided(problem: Problem, explanation: Explanation) -> tuple[Choice, Structure, bool]:
    """What stays of the best choice, the structured rest, and whether the accuracy decided."""
    best = sure_of_slow(explanation, undisguised(explanation.choices))
    best = unless_nothing(explanation, one_for_many(explanation, best))
    structure = structure_of(explanation, best)
    base = next(c for c in explanation.choices if not c.fit.pieces)
    if within_accuracy(base, explanation.used):
        alone = calibrated_alone(base, explanation.used)
        return alone, Structure(False, None, structure.share, structure.p_value), True
    absurd = absurd_calibration(best.fit)
    if not follows(explanation, best):
        structure, best = replace(structure, found=True, where="everywhere"), base
    elif cancelling(best):
        structure, best = replace(structure, found=True, where=CANCELLED), base
    elif absurd is not None:
        structure = replace(structure, found=True, where=absurd)
    unrepeated = explanation.prior.repeats == 0 and problem.derivatives is None and testable(best)
    judge = without_repeats if unrepeated else by_repeats
    best, structure = judge(problem, explanation, best, structure, absurd is None)
    if not structure.found:
        off, counted = counted_errors(problem, explanation, best, predicted_by(problem, best))
        drifts = walks_far(explanation, best)
        where = strained(problem, off, counted, best.fit.ground.noise, drifts)
        structure = replace(structure, found=where is not None, where=where or structure.where)
    if structure.found:
        share = max(structure.share, share_left(explanation, best))
        structure = replace(structure, share=share)
        best = best if best.fit.pieces else evenly_calibrated(best, explanation.used)
    return best, structure, False


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
    kept = fewer(explanation, best)
    return kept, told_but_for_its_form(explanation, kept, structure) if sound else structure


def without_repeats(
    problem: Problem, explanation: Explanation, best: Choice, structure: Structure, sound: bool
) -> tuple[Choice, Structure]:
    """What stays where nothing says what noise is: beside a rest only what foretells later rows.

    A small rest is the form of the names before any of them goes; held-out rows that refute the
    names as they are do so whatever is left.
    """
    if structure.found and sound:
        structure = told_but_for_its_form(explanation, best, structure)
    if not structure.found:
        structure = disproved(problem, explanation, best, predicted_by(problem, best), structure)
        if structure.wandering is not None:
            structure = told_but_for_its_form(explanation, best, structure)
    rest = structure.share * mismatch_variance(explanation)
    kept = foretold_part(explanation.choices, best, rest) if structure.found else best
    return kept, structure


def predicted_by(problem: Problem, choice: Choice) -> np.ndarray:
    """What a choice predicts of every row from the start of the recording, (n,)."""
    return mechanism_of(problem, choice).respond(problem.motion)[0]

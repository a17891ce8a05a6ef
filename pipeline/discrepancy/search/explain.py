"""Explaining one measurement: noise, outliers, and the sets of terms that explain the rest."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from pipeline.discrepancy.fitting.effects import effects_of
from pipeline.discrepancy.fitting.fit import ITERATIONS, evaluate, improve
from pipeline.discrepancy.fitting.ground import ground_of
from pipeline.discrepancy.noise.family import JUDGED, noise_family
from pipeline.discrepancy.noise.learning import NoisePrior, learn_noise
from pipeline.discrepancy.problem.outliers import isolated
from pipeline.discrepancy.problem.problem import Problem
from pipeline.discrepancy.problem.thinning import sparser
from pipeline.discrepancy.search.accuracy import within_accuracy
from pipeline.discrepancy.search.alone import alone
from pipeline.discrepancy.search.choose import choose, choose_again, extended
from pipeline.discrepancy.search.contested import contested, levelled
from pipeline.discrepancy.search.counted import (
    farthest,
    mistaken_rows,
    repeats_of,
    settled_rows,
    usual,
)
from pipeline.discrepancy.search.cubed import cubed
from pipeline.discrepancy.search.disguise import with_plain
from pipeline.discrepancy.search.excited import excited_terms
from pipeline.discrepancy.search.force_zero import jittering
from pipeline.discrepancy.search.foretold import foretelling
from pipeline.discrepancy.search.growth import grown
from pipeline.discrepancy.search.odd import oddly
from pipeline.discrepancy.search.plain_forms import begun_plainly
from pipeline.discrepancy.search.polish import polished
from pipeline.discrepancy.search.pressed import pressed
from pipeline.discrepancy.search.refuted import (
    doubtful,
    hopeless,
    not_noise,
    refuted,
    worth_a_polish,
)
from pipeline.discrepancy.search.second_order import swinging
from pipeline.discrepancy.search.sprung import sprung
from pipeline.discrepancy.search.weighing import (
    LEAST_GAIN,
    RIVAL_GAP,
    SAME,
    Choice,
    Search,
    best_of_each,
    by_names,
    piled,
)

TURNS, STANDING, SETTLED = 4, 1.0, 3
JUDGED_GAP = 25.0
MANY = 0.01


@dataclass(frozen=True)
class Explanation:
    """choices: the best first. outliers: (n,) mask over the problem's rows. used: rows fitted.

    zero: (n,) where the zero wanders beside what the choices predict, 0 where it does not.
    """

    problem: Problem
    prior: NoisePrior
    search: Search
    choices: list[Choice]
    outliers: np.ndarray
    used: np.ndarray
    zero: np.ndarray | float = 0.0


def explain(problem: Problem) -> Explanation:
    """The sets of terms that explain a problem's training rows.

    They are looked for with few of the samples behind its rows, then fitted with all of them.
    """
    sparse = sparser(problem)
    found = searched(sparse)
    return found if sparse is problem else fitted_with_all(problem, found)


def fitted_with_all(problem: Problem, found: Explanation) -> Explanation:
    """What was found with fewer samples behind the same rows, with all of them.

    Choices that come near the best are fitted and weighed anew; the others stay as far behind.
    """
    ground = ground_of(problem, found.prior.model, found.used)
    best = found.choices[0].score
    near = [c.score < best + RIVAL_GAP or not c.fit.pieces for c in found.choices]
    fits = [evaluate(ground.with_noise(c.fit.ground.noise), c.fit.pieces) for c in found.choices]
    again = {
        k: found.search.weighed(improve(fit), found.choices[k].place)
        for k, fit in enumerate(fits)
        if near[k]
    }
    moved = again[0].score - best
    choices = [
        again.get(k, replace(choice, fit=fits[k], score=choice.score + moved))
        for k, choice in enumerate(found.choices)
    ]
    choices.sort(key=lambda c: c.score)
    return replace(found, problem=problem, choices=choices)


def searched(problem: Problem) -> Explanation:
    """The sets of terms that explain a problem's training rows, looked for from nothing.

    Outliers are judged on the residual of the best explanation, so that a sharp corner is none;
    where that changes them, or what is known of the noise, the choice is made anew, and once more
    where that changes MANY of them: so many had bent the first choice. Where calibration alone
    leaves no more than the accuracy that was declared, no terms are looked for. Where cycles that
    repeat say that what the best leaves is no noise, no name is sure, and none is contested.
    """
    prior = learn_noise(problem)
    candidates = excited_terms(problem)
    effects = effects_of(problem, candidates)
    settled = settled_rows(problem, prior)
    off = np.where(problem.train, problem.measured - problem.simulated, np.nan)
    repeats = repeats_of(problem, prior)
    outliers = isolated(off, problem.train, prior.finest, problem.cycle, repeats)
    outliers &= ~(usual(problem, off, prior) | farthest(problem, off, outliers))
    used = problem.train & settled & ~outliers
    search = Search(candidates, effects, noise_family(prior, problem, used))
    ground = ground_of(problem, prior.model, used)
    base = search.weighed(evaluate(ground, ()), (0, 0, 0))
    if within_accuracy(base, used):
        outliers = mistaken_rows(problem, base, prior)
        return Explanation(problem, prior, search, [base], outliers, used)
    choices = choose(search, ground)
    before, prior = prior, learnt_again(search, choices[0])
    off_now = mistaken_rows(problem, choices[0], prior)
    if prior is not before or not np.array_equal(off_now, outliers):
        search, used, choices = chosen_anew(search, prior, settled & ~off_now, choices)
        last, off_now = off_now, mistaken_rows(problem, choices[0], prior)
        if np.sum(off_now != last) > MANY * len(off_now):
            search, used, choices = chosen_anew(search, prior, settled & ~off_now, choices)
    found = begun_plainly(search, seldom_or_polished(search, choices))
    told = pressed(search, sprung(search, alone(search, found)))
    usual_ones = unless_misfit(search, searched_wide(search, choices, swinging(search, told)))
    choices = oddly(search, usual_ones)
    if choices[0].score < usual_ones[0].score:
        choices = unless_misfit(search, choices)
    choices = grown_last(search, choices)
    if prior.repeats == 0 and problem.derivatives is None:
        search, choices = judged(search, choices)
        near = [c for c in by_names(choices) if c.score < choices[0].score + RIVAL_GAP][:SETTLED]
        still = [resettled(search, c) if any(c is n for n in near) else c for c in choices]
        choices = foretelling(with_slow_terms(search, still))
    if problem.derivatives is not None:
        choices = jittering(search, choices)
    choices = with_plain(search, cubed(search, choices))
    outliers = mistaken_rows(problem, choices[0], prior)
    return Explanation(problem, prior, search, choices, outliers, used)


def seldom_or_polished(search: Search, choices: list[Choice]) -> list[Choice]:
    """The choices polished; where repeats speak much against the best, what is seldom comes first.

    A polish would pile up names in its place, for many rounds.
    """
    if doubtful(search, choices[0]):
        seldom = oddly(search, choices)
        if not not_noise(search, seldom[0]):
            return seldom
    return polished(search, choices)


def unless_misfit(search: Search, choices: list[Choice]) -> list[Choice]:
    """The choices, levelled and contested; as they are where what the best leaves is no noise."""
    if not_noise(search, choices[0]):
        return choices
    return contested(search, levelled(search, choices))


def chosen_anew(
    search: Search, prior: NoisePrior, counted: np.ndarray, choices: list[Choice]
) -> tuple[Search, np.ndarray, list[Choice]]:
    """The search, the rows used and the choices where other training rows (n,) are counted."""
    problem = choices[0].fit.ground.problem
    used = problem.train & counted
    again = Search(search.terms, search.effects, noise_family(prior, problem, used))
    return again, used, choose_again(again, ground_of(problem, prior.model, used), choices)


def grown_last(search: Search, choices: list[Choice]) -> list[Choice]:
    """The choices and all that were weighed on the way to them.

    Where the best of all can still grow, with what a polish of that comes to.
    """
    choices = best_of_each([*choices, *search.seen.values()])
    richer = grown(search, choices[0])
    if richer.score > choices[0].score - LEAST_GAIN:
        return choices
    more = best_of_each([richer, *choices])
    if not worth_a_polish(search, richer, choices[0]):
        return more
    return best_of_each([*polished(search, more), *search.seen.values()])


def searched_wide(search: Search, begun: list[Choice], found: list[Choice]) -> list[Choice]:
    """The choices; where the best is a pile of names, those of a search without shortcuts.

    As many names as a search takes may mop up what others explain: what gains most at first is then
    not on the way to what explains most. begun: the choices that those found were polished from;
    from a best that is no better, a polish would come to no better. No search leads out of what is
    hopeless.
    """
    if not piled(found[0]) or hopeless(search, found[0]):
        return found
    wide = replace(search, wide=True)
    again = choose(wide, found[0].fit.ground)
    if again[0].score < min(c.score for c in begun) - SAME:
        again = polished(wide, again)
    return best_of_each([*found, *again])


def learnt_again(search: Search, choice: Choice) -> NoisePrior:
    """The noise as it was learnt, or from what a choice leaves, if repeats differ by less there.

    A slip or drift before a curve that bends moves each part of the next cycles by another amount.
    Contrasts of repeats don't cancel that, and speak against the noise of what explains it; those
    of what it leaves do not.
    """
    before, ground = search.family.prior, choice.fit.ground
    if not (choice.fit.slow and refuted(search, choice)):
        return before
    left = learn_noise(ground.problem, choice.fit.predicted)
    other = replace(search, family=noise_family(left, ground.problem, ground.used))
    return left if left.differing < before.differing and not refuted(other, choice) else before


def judged(search: Search, choices: list[Choice]) -> tuple[Search, list[Choice]]:
    """The search with a jitter charged as it is usual, and the choices near the best weighed so.

    While terms are looked for, a zero that jitters would take the place of slips and drifts yet to
    be found. Then it is as good an explanation of zeros that differ a little as these are.
    """
    family = replace(search.family, unrepeated_jitter=JUDGED)
    last = replace(search, family=family, vain={}, seen={})
    near = [c for c in by_names(choices) if c.score < choices[0].score + JUDGED_GAP]
    again = [last.weighed(c.fit, c.place) if any(c is n for n in near) else c for c in choices]
    return last, sorted(again, key=lambda c: c.score)


def resettled(search: Search, choice: Choice) -> Choice:
    """A choice fitted and weighed by turns until its score stands still."""
    for _ in range(TURNS):
        again = search.weighed(improve(choice.fit), choice.place, 2 * ITERATIONS)
        if again.score > choice.score - STANDING:
            break
        choice = again
    return choice


def with_slow_terms(search: Search, choices: Sequence[Choice]) -> list[Choice]:
    """The choices, and the best without a slow change also with one.

    Without repeats, noise that varies slowly hides slow changes.
    """
    slow = replace(search, terms=tuple(t for t in search.terms if t.slow))
    found = {c.fit.key: c for c in choices}
    still = [c for c in choices if not c.fit.slow]
    for parent in sorted(still, key=lambda c: c.score)[:1]:
        for child in extended(slow, parent, skip=found):
            found[child.fit.key] = child
    return list(found.values())

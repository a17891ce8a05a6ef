"""The verdict: how many names does the best choice bear, beside what it leaves?"""

from dataclasses import replace

import numpy as np

from pipeline.discrepancy.fitting.calibration import FAR_OFF
from pipeline.discrepancy.fitting.charge import VOID, absurd_calibration
from pipeline.discrepancy.fitting.fit import drifted, evaluate, improve
from pipeline.discrepancy.judgement.rest import structured_rest
from pipeline.discrepancy.judgement.structure import (
    CHANGES,
    NO_FORM,
    RINGS,
    UNSTEADY,
    Structure,
    mismatch_variance,
    share_left,
    structure_of,
)
from pipeline.discrepancy.noise.family import usual_charge
from pipeline.discrepancy.search.explain import Explanation
from pipeline.discrepancy.search.growth import grown
from pipeline.discrepancy.search.pressed import plainer
from pipeline.discrepancy.search.weighing import RIVAL_GAP, Choice, names, piled, wanders
from pipeline.physics.drift import Drift

ENOUGH, TWICE = 0.7, 2.0
MOST_LEFT = 0.1
PLAINLY, PLAINLY_OF_PILE = 4.0, 8.0
UNFOLLOWED = 0.7
FORM_ERROR = 0.05
ODDS, OVER_RESTLESS, BESIDE, RESTLESS, COMMONER = 10.0, 3.0, 3.0, 7.0, 9.0
USUAL_WALK, USUAL_JITTER = 3, 4  # places: 0.017 of the noise from row to row; 0.6 of it by cycle


def intolerable(choice: Choice) -> bool:
    """Whether gain or offset is off by more than FAR_OFF of its declared tolerances.

    The offset of a force that drifts is that of its zero on average.
    """
    fit, tolerance = choice.fit, choice.fit.ground.problem.tolerance
    gain = abs(fit.nuisance[0] - fit.expected[0])
    offset = abs(fit.ground.nuisances.offset(fit.nuisance) + drifted(fit.ground, fit.pieces))
    return bool(gain > FAR_OFF * tolerance.gain or offset > FAR_OFF * tolerance.offset)


def follows(explanation: Explanation, choice: Choice) -> bool:
    """Whether the explanation tells the measurement's variation better than its mean would."""
    measured = explanation.problem.measured[explanation.used]
    noisy = explanation.prior.model.deviation > 0.5 * float(np.std(measured))
    if noisy and not choice.fit.pieces:
        return True
    return mean_square(explanation, choice) < UNFOLLOWED * float(np.var(measured))


def sure_of_slow(explanation: Explanation, best: Choice) -> Choice:
    """The best choice, without its drift and slips where they may be noise that wanders.

    Such a zero is nothing to be named by itself: the odds against it must be those of `least_lead`.
    Beside other names the simulation is known to leave things out, and a zero that walks is told as
    the drift or slip that fits about as well; one that is as restless as hardly a sensor's is, as
    what makes it calmer, even if that is worth no more than its own charge. Nor is a drift or slip
    told beside them that fits hardly better than a zero that jitters from cycle to cycle, which is
    COMMONER times as common.
    """
    others = names(best) - best.fit.slow
    if others and best.fit.slow:
        return unslowed(explanation, best)
    if not others:
        return unless_it_wanders(explanation, best)
    if explanation.prior.repeats == 0:
        return best
    slow = [c for c in explanation.choices if c.fit.slow and names(c) - c.fit.slow == others]
    restless, walk = moves_unusually(best), best.place[2]
    calmer = [c for c in slow if unrest(c) < unrest(best) and (restless or c.place[2] < walk)]
    told = min(calmer, key=lambda c: c.score, default=best)
    within = RESTLESS if restless else BESIDE
    return told if told.score < best.score + within else best


def unless_nothing(explanation: Explanation, best: Choice) -> Choice:
    """The best choice, or none of its names where these are hardly likelier than no mismatch.

    A recording that holds nothing is searched with hundreds of forms: the odds for the best of them
    must be those of `least_lead` beyond what each is charged.
    """
    base = next(c for c in explanation.choices if not c.fit.pieces)
    return base if base.score < best.score + least_lead(explanation, best, base) else best


def least_lead(explanation: Explanation, best: Choice, rival: Choice) -> float:
    """-2 log of the odds that the best choice must have against one of fewer names: ODDS to 1.

    But even ones, where cycles repeat, for a drift alone in place of a zero that walks: by their
    terms' charges such a zero comes out as a drift in one of fifty recordings. Where none repeats,
    OVER_RESTLESS to 1 in place of one that walks more than a sensor's does.
    """
    drift = names(best) == {Drift.name} and best.place[2] == 0 < rival.place[2]
    if drift and explanation.prior.repeats > 0:
        return 0.0
    restless = drift and rival.place[2] > USUAL_WALK
    return 2.0 * float(np.log(OVER_RESTLESS if restless else ODDS))


def unless_it_wanders(explanation: Explanation, best: Choice) -> Choice:
    """The best choice, or one of fewer names beside a zero that wanders, unless odds are against.

    A zero that moves is charged as where cycles repeat: then it is as usual as a drift. Nor is it
    held against one that it wanders by more than the noise, where no cycles say what noise is: what
    follows the commands of it shows as structure.
    """
    search = explanation.search

    def evenly(choice: Choice) -> float:
        unusual = search.family.charge(choice.place) - usual_charge(choice.place)
        if explanation.prior.repeats == 0 and search.hides_drift(choice.fit, choice.place):
            unusual += VOID
        return choice.score - unusual

    fewer_names = [c for c in explanation.choices if names(c) < names(best)]
    rival = min((c for c in fewer_names if wanders(c.place)), key=evenly, default=best)
    return rival if evenly(rival) < evenly(best) + least_lead(explanation, best, rival) else best


def unslowed(explanation: Explanation, best: Choice) -> Choice:
    """The best choice, or what fits nearly as well by a usual jitter as by its slow names."""
    others = names(best) - best.fit.slow
    usual = range(1, USUAL_JITTER + 1)
    jittering = [c for c in explanation.choices if c.place[1] in usual and c.place[2] == 0]
    rivals = [c for c in jittering if names(c) == others]
    rival = min(rivals, key=lambda c: c.score, default=best)
    return rival if rival.score < best.score + 2.0 * np.log(COMMONER) else best


def moves_unusually(choice: Choice) -> bool:
    """Whether a choice's zero walks or jitters more than a sensor's does."""
    walk, jitter = unrest(choice)
    return walk > USUAL_WALK or jitter > USUAL_JITTER


def unrest(choice: Choice) -> tuple[int, int]:
    """How much a choice's zero walks, and how much it jitters: places on the scales of either."""
    _, jitter, walk = choice.place
    return walk, jitter


def fewer(explanation: Explanation, choice: Choice, structure: Structure) -> Choice:
    """At most one name where a structured rest shows that these terms only mop it up.

    Where that rest is less than a twentieth of the mismatch (RMS), all names stay that explain more
    than they leave together: then it is the form of a term, but not of as many as a search takes.
    So do those that each explain four times what they leave together, or, of as many names as a
    search takes that leave more than the noise, eight times. A force's terms take the forms that
    suit them once others are gone; where its law changes, each explains more than all of them leave
    together, for that is more than shows as a change. Beside what rings, or goes from cycle to
    cycle by more than that, there is one at most: several follow that on average.
    """
    if not choice.fit.pieces:
        return choice
    if explanation.problem.motion.kinetics is not None:
        changes = structure.where == CHANGES
        structured = np.inf if changes else structured_square(explanation, choice)
        kept = weightier(explanation, choice, structured)
        if kept is not choice:
            kept = grown(explanation.search, kept)
        return plainer(explanation.search, kept)
    before = left_to_names(explanation)
    sure = structure.share * mismatch_variance(explanation)
    rest = max(rest_of(choice, explanation) ** 2, sure)
    small = not piled(choice) and rest < FORM_ERROR**2 * before
    several = len(names(choice)) > 1
    if small and not (several and structure.where == RINGS):
        return weightier(explanation, choice, np.inf)
    if several and structure.where in UNSTEADY:
        return one_at_most(explanation, choice)
    return beside_a_rest(explanation, choice, sure)


def beside_a_rest(explanation: Explanation, choice: Choice, sure: float) -> Choice:
    """What plainly stays of a choice that leaves a structured rest; if that is a pile, one at most.

    sure: mean square of the rest.
    """
    noise = explanation.prior.model.deviation**2
    plainly = asked_of(explanation, choice, noise)
    told = plainly_told(explanation, choice, noise, plainly, sure)
    return told if told.fit.pieces and not piled(told) else one_at_most(explanation, choice)


def earning(explanation: Explanation, choice: Choice, sure: float) -> Choice:
    """Names that each explain at least TWICE what they leave together (mean squares), or one.

    That is what is beyond the noise, the structure that shows in it, and what is `sure`. The one
    that explains least goes first.
    """
    fit, noise = choice.fit, explanation.prior.model.deviation**2
    if len(names(choice)) < 2:
        return choice
    needed = max(fit.mean_square - noise, rest_of(choice, explanation) ** 2, sure)
    without = [choice.but_for(name) for name in sorted(names(choice))]
    least = min(without, key=lambda other: other.fit.mean_square)
    if least.fit.mean_square - fit.mean_square >= TWICE * needed:
        return choice
    return earning(explanation, least, sure)


def one_at_most(explanation: Explanation, choice: Choice) -> Choice:
    """The best name of a choice that only mops up, if it alone explains enough; else none.

    That is most of the mismatch, and nine tenths of its structure, which the noise that was learnt
    from repeats may hide.
    """
    base = next(c for c in explanation.choices if not c.fit.pieces)
    noise, before = explanation.prior.model.deviation**2, left_to_names(explanation)
    single = min(singles(explanation, choice), key=lambda c: c.score)
    left = mean_square(explanation, single) - noise
    enough = left < (1.0 - ENOUGH) * before
    return single if enough and rest_of(single, explanation) ** 2 < MOST_LEFT * before else base


def leaves_much(explanation: Explanation, choice: Choice) -> bool:
    """Whether several names leave more than one alone might (`one_at_most`), shared among them."""
    left = mean_square(explanation, choice) - explanation.prior.model.deviation**2
    most = (1.0 - ENOUGH) * left_to_names(explanation)
    return len(names(choice)) > 1 and left * len(names(choice)) > most


def told_but_for_its_form(
    explanation: Explanation, choice: Choice, structure: Structure
) -> Structure:
    """The structure, which is none to be told where it is only the form of the names that stay.

    It is where all that is left beyond the noise is less than a twentieth of the mismatch (RMS):
    a real wire is never quite the term. What gain and offset explain of it is no form of any name.
    Its share and place stay. What swings, sticks or is at two places by turns is no form of theirs.
    """
    share = max(structure.share, share_left(explanation, choice))
    small = share * mismatch_variance(explanation) < FORM_ERROR**2 * left_to_names(explanation)
    formal = small and structure.where not in NO_FORM
    told = choice.fit.pieces and not piled(choice) and formal
    return replace(structure, found=False, share=share) if told else structure


def left_to_names(explanation: Explanation) -> float:
    """Mean square of the mismatch beyond the noise that gain and offset leave."""
    base = next(c for c in explanation.choices if not c.fit.pieces)
    return mean_square(explanation, base) - explanation.prior.model.deviation**2


def rest_of(choice: Choice, explanation: Explanation) -> float:
    """Size (RMS) [measurement's unit] of the largest structure that a choice leaves."""
    rests = structured_rest(choice, explanation.search.family)
    return max((r.size for r in rests), default=0.0)


def singles(explanation: Explanation, choice: Choice) -> list[Choice]:
    """Choices of one name: those found, and each name of a choice fitted alone."""
    found = [c for c in explanation.choices if len(set(c.fit.names)) == 1]
    for name in dict.fromkeys(choice.fit.names):
        own = [p for p in choice.fit.pieces if p.term.name == name]
        fit = improve(evaluate(choice.fit.ground, own))
        found.append(explanation.search.weighed(fit, choice.place))
    return found


def structured_square(explanation: Explanation, choice: Choice) -> float:
    """Mean square of the structure that a choice leaves of a force; infinite where none shows.

    What a force leaves is for the most part noise, and no measure of what mops up the structure.
    """
    structure = structure_of(explanation, choice)
    if not structure.found:
        return np.inf
    share = structure.share * mismatch_variance(explanation)
    return max(share, rest_of(choice, explanation) ** 2)


def weightier(explanation: Explanation, choice: Choice, structured: float) -> Choice:
    """Only terms that explain more than all of them together leave, or than is structured of that.

    What explains less may merely mop up the rest, and so may what moves the zero if it explains
    less than all that is left. The one that explains least goes first, but of a force
    none whose place an absurd gain of the simulation would take.
    """
    left, without = mean_square(explanation, choice), []
    of_force = explanation.problem.derivatives is not None
    for piece in choice.fit.pieces:
        rest = choice.fit.without(piece)
        fit = improve(evaluate(choice.fit.ground, rest))
        needed = left if piece.term.slow else min(left, structured)
        explained = mean_square(explanation, replace(choice, fit=fit)) - left
        if of_force and absurd_calibration(fit) and not absurd_calibration(choice.fit):
            explained = np.inf
        without.append((explained / max(needed, 1e-300), fit))
    least, fit = min(without, key=lambda w: w[0], default=(np.inf, choice.fit))
    if least >= 1.0:
        return choice
    return weightier(explanation, explanation.search.weighed(fit, choice.place), structured)


def asked_of(explanation: Explanation, choice: Choice, noise: float) -> float:
    """How many times what all of them leave each name must explain to be told beside that.

    noise: its mean square. More of a pile of names that leaves more than the noise.
    """
    more = piled(choice) and mean_square(explanation, choice) > 2.0 * noise
    return PLAINLY_OF_PILE if more else PLAINLY


def plainly_told(
    explanation: Explanation, choice: Choice, noise: float, plainly: float, sure: float = 0.0
) -> Choice:
    """Only terms that each explain `plainly` times what they leave together.

    That is what is beyond the noise (its mean square), the structure that shows in it: noise that
    was learnt from repeats may hold it; what is `sure` (mean square) of rows set aside; or what is
    followed that has no name. The one that explains least goes first.
    """
    left = mean_square(explanation, choice)
    needed, without = max(left - noise, rest_of(choice, explanation) ** 2, sure), []
    for piece in choice.fit.pieces:
        fit = improve(evaluate(choice.fit.ground, choice.fit.without(piece)))
        explained = mean_square(explanation, replace(choice, fit=fit)) - left
        if piece.term.nameless:
            needed = max(needed, explained)
        else:
            without.append((explained, fit))
    least, fit = min(without, key=lambda w: w[0], default=(np.inf, choice.fit))
    if least >= plainly * needed:
        return choice
    fewer_told = explanation.search.weighed(fit, choice.place)
    return plainly_told(explanation, fewer_told, noise, plainly, sure)


def without(explanation: Explanation, choice: Choice, name: str) -> Choice:
    """A choice without a name: refitted, or one found that is as likely and no richer in pieces.

    Whichever leaves less. What stood beside the name may have shrunk to make room for it, and not
    find back. Beside what is more than its name, no other is of the same names. And what takes the
    place of a slow change in the rows fitted does not in later ones.
    """
    rest, least = names(choice) - {name}, choice.score + RIVAL_GAP
    alone = name in choice.fit.slow or any(p.term.beyond for p in choice.fit.pieces)
    likely = [] if alone else [c for c in explanation.choices if c.score < least]
    most = len(choice.fit.but_for(name))
    found = [c for c in likely if names(c) == rest and len(c.fit.pieces) <= most]
    return min([choice.but_for(name), *found], key=lambda c: mean_square(explanation, c))


def mean_square(explanation: Explanation, choice: Choice) -> float:
    """Mean square of a choice's residual on the rows fitted."""
    residual = explanation.problem.measured - choice.fit.predicted
    return float(np.mean(residual[explanation.used] ** 2))

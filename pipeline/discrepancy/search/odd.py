"""What is seldom, or no name of the catalogue, in place of what mops it up."""

from dataclasses import replace
from itertools import combinations

from pipeline.discrepancy.fitting.fit import ITERATIONS, evaluate, improve
from pipeline.discrepancy.fitting.screen import screen, started
from pipeline.discrepancy.search.choose import allowed, by_term, extended
from pipeline.discrepancy.search.growth import grown
from pipeline.discrepancy.search.polish import polished
from pipeline.discrepancy.search.refuted import not_noise, worth_a_polish
from pipeline.discrepancy.search.snapped import snapped_into_place
from pipeline.discrepancy.search.strung import strung
from pipeline.discrepancy.search.weighing import (
    LEAST_GAIN,
    Choice,
    Search,
    among,
    best_of_each,
    names,
)
from pipeline.physics.catalogue import ODD, with_richer

STEPS, NEAR, FIRM, MOST_KEPT, AT_ONCE = 4, 40.0, 100.0, 2, 2
ODD_FORMS = {(t.name, t.form) for t in with_richer(ODD)}


def oddly(search: Search, choices: list[Choice]) -> list[Choice]:
    """The choices (best first), and those with one of ODD in place of a piece, or of all but two.

    A search takes other names for what these explain, two or three for each, and no step leads from
    there. It does not begin with them: each comes near what a usual term does, and would hide that.
    Nor does it remember those that may only mop up. Where cycles that repeat say that no more than
    noise is left, one of them is better only in place of AT_ONCE pieces, or of the only one; else
    friction and a wire that stretches under it are begun at once, too (`strung.py`).
    """
    search = replace(search, seen={})
    best, ground = choices[0], choices[0].fit.ground
    motion, around = ground.problem.motion, ground.problem.around
    shown = tuple(t for t in ODD if t.excited(motion, around))
    if motion.kinetics is not None or ground.problem.mixed or not shown:
        return choices
    other = among(search, ground.problem, shown)
    pieces, most = best.fit.pieces, len(best.fit.pieces)
    noise_alone = search.family.prior.repeats > 0 and not not_noise(search, best)
    if noise_alone:
        most = max(most - AT_ONCE, 0)
    few = (rest for size in range(MOST_KEPT + 1) for rest in combinations(pieces, size))
    sets = (*few, *map(best.fit.without, pieces))
    kept = {tuple(map(id, rest)): rest for rest in sets if len(rest) <= most}
    found = [] if noise_alone else strung(search, best)
    for rest in kept.values():
        fit = improve(evaluate(ground, rest), STEPS)
        for leads in by_term(screen(fit, other.effects, allowed(shown, fit), quick=True)):
            trial = snapped_into_place(improve(started(fit, leads), STEPS))
            if search.hoped(trial, best.place) < best.score + NEAR:
                found.append(search.weighed(improve(trial, 2 * ITERATIONS), best.place))
    more = best_of_each([*choices, *found])
    if more[0].score < best.score - LEAST_GAIN:
        more = best_of_each([*more, *by_themselves(search, more[0])])
        if not worth_a_polish(search, more[0], best):
            more = best_of_each([*more, *extended(search, more[0])])
        if worth_a_polish(search, more[0], best):
            more = polished(search, more)
    return [c for c in more if not may_mop_up(c, best)]


def by_themselves(search: Search, choice: Choice) -> list[Choice]:
    """Those of ODD in a choice without its other terms, in the forms that suit them best so.

    What stands beside one may be what a form of it has besides.
    """
    own = [p for p in choice.fit.pieces if (p.term.name, p.term.form) in ODD_FORMS]
    if not 0 < len(own) < len(choice.fit.pieces):
        return []
    fit = improve(evaluate(choice.fit.ground, own), 2 * ITERATIONS)
    return [grown(search, search.weighed(fit, choice.place))]


def may_mop_up(choice: Choice, best: Choice) -> bool:
    """Whether one of ODD was taken besides as many names, for hardly more than others leave."""
    odd = not choice.fit.key.isdisjoint(ODD_FORMS)
    further = len(names(choice)) > len(names(best))
    return bool(odd and further and choice.score > best.score - FIRM)

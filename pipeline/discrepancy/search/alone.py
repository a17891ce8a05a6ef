"""One bend or play in a richer form in place of several names."""

from pipeline.discrepancy.fitting.effects import late
from pipeline.discrepancy.search.choose import extended
from pipeline.discrepancy.search.polish import polished
from pipeline.discrepancy.search.refuted import not_noise, worth_a_polish
from pipeline.discrepancy.search.weighing import Choice, Search, among, best_of_each
from pipeline.physics.backlash import Backlash
from pipeline.physics.catalogue import BEND, UNEVENLY_WORN, richer
from pipeline.physics.term import Term


def alone(search: Search, choices: list[Choice]) -> list[Choice]:
    """The choices (best first), and those of one richer form.

    These where the best has several names, or is a loop that leaves what is no noise, as repeats
    say. What a richer form of a bend explains that its plain one can't is taken up by others
    (ripple, contact, stops) as a search grows: no step leads from them to the one. So is what
    differs in worn play from place to place; grown from plain play, that would mop up what comes
    beside it.
    """
    best = choices[0]
    base = next(c for c in choices if not c.fit.pieces)
    one_loop = bool(late(best.fit)) and not_noise(search, best)
    if len(best.fit.pieces) < 2 and not one_loop:
        return choices
    problem = base.fit.ground.problem
    bends = (t for t in unsearched(search) if t.group == BEND)
    worn = UNEVENLY_WORN if any(t.name == Backlash.name for t in search.terms) else ()
    found = extended(among(search, problem, (*bends, *worn)), base)
    more = best_of_each([*choices, *found])
    if more[0].score < best.score and worth_a_polish(search, more[0], best):
        return polished(search, more)
    return more


def unsearched(search: Search) -> list[Term]:
    """The richer forms of a search's terms that it does not begin with."""
    known = {(t.name, t.form) for t in search.terms}
    forms = {(r.name, r.form): r for t in search.terms for r in richer(t)}
    return [form for key, form in forms.items() if key not in known]

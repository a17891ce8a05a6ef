"""Choosing terms: a beam over sets, every parameter refitted."""

from collections.abc import Callable, Container, Hashable, Sequence
from dataclasses import replace
from typing import TypeVar

from pipeline.discrepancy.fitting.charge import TERM_COST
from pipeline.discrepancy.fitting.fit import Fit, calibrated, evaluate, improve
from pipeline.discrepancy.fitting.ground import Ground
from pipeline.discrepancy.fitting.moments import settle_moments
from pipeline.discrepancy.fitting.screen import Lead, screen, started
from pipeline.discrepancy.search.elsewhere import (
    Key,
    differing,
    in_better_order,
    kin_of,
    with_others_elsewhere,
)
from pipeline.discrepancy.search.growth import grown
from pipeline.discrepancy.search.weighing import (
    FAINT,
    LEAST_GAIN,
    MOST_TERMS,
    Choice,
    Search,
    wanders,
)
from pipeline.physics.term import Term

BEAM = 3
BRANCHES = 7
EARLIER = 6
LAGGARD, HOPELESS, BEHIND = 0.3, 0.1, 0.5

T = TypeVar("T")


def choose(search: Search, ground: Ground) -> list[Choice]:
    """Choices by a beam, not yet polished; each set of terms once.

    Where nothing repeats, noise that walks is as likely all that was left out, and beside it
    nothing promises much: the terms are then looked for beside noise that does not. What begins
    each set in too narrow a form would draw more terms: it is grown before these are looked for.
    """
    base = search.weighed(evaluate(ground, ()), (0, 0, 0))
    if wanders(base.place) and search.family.prior.repeats == 0:
        steady = replace(search, family=replace(search.family, steady=True), vain={})
        begun = [c for c in choose(steady, ground) if c.fit.pieces]
        free = [search.weighed(c.fit, c.place) for c in begun[:EARLIER]]
        return sorted([base, *free, *begun[EARLIER:]], key=lambda c: c.score)
    found = {base.fit.key: base}
    beam = [base]
    for depth in range(MOST_TERMS):
        before = min(c.score for c in found.values())
        level: dict[Key, Choice] = {}
        for parent in beam:
            for child in extended(replace(search, quick=True), parent):
                if child.fit.key not in level or child.score < level[child.fit.key].score:
                    level[child.fit.key] = child
        if not level:
            break
        beam = promising(list(level.values()), base.score, search.clear)
        suited = len(beam) if depth == 0 else int(beam[0].score < before)
        beam[:suited] = [grown(search, c) for c in beam[:suited]]
        level |= {c.fit.key: c for c in beam}
        found |= {k: c for k, c in level.items() if k not in found or c.score < found[k].score}
        if beam[0].score > before + LEAST_GAIN:
            break
    best = min(found.values(), key=lambda c: c.score)
    richest = grown(search, best)
    found[richest.fit.key] = richest
    return sorted(found.values(), key=lambda c: c.score)


def choose_again(search: Search, ground: Ground, earlier: Sequence[Choice]) -> list[Choice]:
    """Choices on other rows, begun from earlier ones (the best and the empty one)."""
    begun = [*earlier[:EARLIER], *(c for c in earlier[EARLIER:] if not c.fit.pieces)]
    again = [
        search.weighed(calibrated(ground, c.fit.pieces, c.fit.trace), c.place, 8) for c in begun
    ]
    found = {c.fit.key: c for c in again}
    best = min(again, key=lambda c: c.score)
    for child in extended(search, best, skip=found):
        found[child.fit.key] = child
    return list(found.values())


def promising(choices: Sequence[Choice], base: float, clear: float) -> list[Choice]:
    """The best few, but for those that gained much less than the best on an empty explanation."""
    best, *rest = leading(sorted(choices, key=lambda c: c.score), BEAM, lambda c: kin_of(c.fit))
    gain = base - best.score
    near = [c for c in rest if base - c.score > LAGGARD * gain or gain < clear]
    return [best, *near]


def extended(
    search: Search,
    parent: Choice,
    branches: int = BRANCHES,
    skip: Container[Key] = (),
    begun: Sequence[Fit] = (),
) -> list[Choice]:
    """The parent with each of the most promising further terms; sets in `skip` are left out.

    begun: fits of the parent's terms to begin from as well, under the parent's noise. Where that
    wanders, slow terms are also looked for beside noise that does not. Where nothing repeats, the
    noise of the empty explanation is all that was left out: beside it a step may promise little.
    """
    terms = [
        t
        for t in allowed(search.terms, parent.fit)
        if parent.fit.key | {(t.name, t.form)} not in skip
    ]
    starts = [(start, terms) for start in (parent.fit, *begun)]
    for beside, moved in with_others_elsewhere(parent.fit).items():
        starts.append((moved, [t for t in terms if beside in t.matters_to]))
    found: dict[Key, Fit] = {}
    unknown = not parent.fit.pieces and search.family.prior.repeats == 0
    for start, own in starts:
        for trial in trials_beside(search, start, own, branches, 0.0 if unknown else TERM_COST):
            if trial.key not in found or trial.cost < found[trial.key].cost:
                found[trial.key] = trial
    slow = [t for t in terms if t.slow]
    late: list[Fit] = []
    if wanders(parent.place) and slow:
        still = search.stilled(parent.fit, parent.place, 4)[0]
        late = [
            improve(started(still, few), 3, still)
            for few in by_term(screen(still, search.effects, slow, quick=search.quick))
        ]
    trials = worthwhile(search, parent, in_better_order(found), late, max(branches - 2, 3))
    fits = [settle_moments(improve(trial, 8)) for trial in trials]
    return [search.weighed(fit, parent.place) for fit in fits]


def trials_beside(
    search: Search, start: Fit, terms: Sequence[Term], branches: int, least: float
) -> list[Fit]:
    """A fit with each of the terms that promise most, and more than `least`, a few steps on.

    Where all that a quick look promises comes to nothing, of a size that no bounds allow, those
    that some do allow are looked for.
    """
    found: list[Fit] = []
    for quick in dict.fromkeys((search.quick, False)):
        groups = by_term(screen(start, search.effects, terms, quick=quick))
        groups = leading(groups, branches, lambda few: (few[0].term.name, few[0].term.kin))
        for few in hopeful(groups, least, search.clear):
            trial = improve(started(start, few), 3, start)
            if trial.cost > start.cost - TERM_COST:
                trial = improve(trial, 6)
            found.append(trial)
        if any(trial.cost < start.cost - TERM_COST for trial in found):
            break
    return found


def worthwhile(
    search: Search, parent: Choice, trials: Sequence[Fit], slow: Sequence[Fit], most: int
) -> list[Fit]:
    """The best few trials, and the best of each slow course, that may still become the best.

    After its steps (more where the first left it behind) a trial is out that is further behind its
    parent than the least charge for a term, or has gained less than half as much as the best one
    that gained clearly. The slow ones were begun under another noise: they may be as far behind as
    they are.
    """
    hopes = {id(t): parent.score - search.hoped(t, parent.place) for t in (*trials, *slow)}

    def hope(trial: Fit) -> float:
        return hopes[id(trial)]

    hoped = [t for t in sorted(trials, key=hope, reverse=True) if hope(t) > -FAINT]
    few = leading(hoped, most, kin_of)
    own: dict[type[Term], Fit] = {}
    for trial in sorted(slow, key=hope, reverse=True):
        own.setdefault(type(trial.pieces[-1].term), trial)
    best: dict[Key, Fit] = {}
    for trial in sorted((*few, *own.values()), key=hope, reverse=True):
        best.setdefault(trial.key, trial)
    most_hoped = max(hopes.values(), default=0.0)
    return [t for t in best.values() if most_hoped < search.clear or hope(t) > BEHIND * most_hoped]


def leading(items: Sequence[T], most: int, idea: Callable[[T], Hashable]) -> list[T]:
    """The first items up to `most` different ideas, and all that are the same idea as one."""
    ideas = set(list(dict.fromkeys(idea(item) for item in items))[:most])
    return [item for item in items if idea(item) in ideas]


def hopeful(groups: Sequence[list[Lead]], least: float, clear: float) -> list[list[Lead]]:
    """Those (best first) that promise more than `least`, and not much less than the best."""
    most = groups[0][0].gain if groups else 0.0
    least = max(least, HOPELESS * most if most > clear else 0.0)
    return [few for few in groups if few[0].gain > least]


def by_term(leads: Sequence[Lead]) -> list[list[Lead]]:
    """Leads of the same term and form together, the most promising term first."""
    groups: dict[tuple[str, str], list[Lead]] = {}
    for lead in leads:
        groups.setdefault((lead.term.name, lead.term.form), []).append(lead)
    return list(groups.values())


def allowed(terms: Sequence[Term], fit: Fit) -> list[Term]:
    """Terms that may stand beside those of a fit: no name twice on a side, none of a group.

    None at another place than the usual one where that makes no difference.
    """
    return [t for t in differing(terms, fit) if not any(excludes(t, p.term) for p in fit.pieces)]


def excludes(term: Term, other: Term) -> bool:
    """Whether two terms can't stand beside each other; what has no name of its own shares none."""
    if term.group:
        return term.group == other.group
    shared = term.nameless == other.nameless
    return shared and (term.name, term.side) == (other.name, other.side)

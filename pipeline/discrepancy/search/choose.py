"""Choosing terms: a beam over sets, every parameter refitted."""

from collections.abc import Callable, Container, Hashable, Sequence
from dataclasses import dataclass, field, replace
from typing import TypeVar

import numpy as np

from pipeline.discrepancy.fitting.charge import TERM_COST, VOID, complexity
from pipeline.discrepancy.fitting.fit import Fit, calibrated, evaluate, improve
from pipeline.discrepancy.fitting.ground import Ground
from pipeline.discrepancy.fitting.moments import settle_moments
from pipeline.discrepancy.fitting.reform import reformed
from pipeline.discrepancy.fitting.screen import Effects, Lead, effects_of, screen, started
from pipeline.discrepancy.noise.family import WHITE, NoiseFamily
from pipeline.discrepancy.problem.problem import Problem
from pipeline.discrepancy.search.elsewhere import (
    Key,
    differing,
    in_better_order,
    kin_of,
    with_others_elsewhere,
)
from pipeline.physics.catalogue import richer, with_richer
from pipeline.physics.term import Term

BEAM = 3
BRANCHES = 7
MOST_TERMS = 4
LEAST_GAIN = 6.0
TIE, RIVAL_GAP = 9.0, 14.0
SAME, CAUGHT_UP = 1.0, 0.3
EARLIER = 6
LAGGARD, CLEAR, HOPELESS = 0.3, 60.0, 0.1
FAINT, BEHIND = 15.0, 0.5
NEAR_WALK, FAR_WALK = 2.0, 25.0


T = TypeVar("T")
Place = tuple[int, int, int]


@dataclass(frozen=True)
class Choice:
    """A fit with its own noise and its score: -2 log evidence (BIC) with a charge for each term."""

    fit: Fit
    place: Place
    score: float


@dataclass(frozen=True)
class Search:
    """What a search needs: the terms that the recording can show and the noises to choose from.

    vain: scores of choices for which a set of forms was tried in vain, and by how much it was
    behind. seen: the best choice of each set of names that was weighed, taken or not. wide: whether
    what gains much less than the best at first is followed, too. quick: whether leads are taken as
    they come: of a beam's many sets few are followed, and what none of their bounds allows is left
    to the polish to find out.
    """

    terms: tuple[Term, ...]
    effects: Effects
    family: NoiseFamily
    vain: dict[Key, tuple[float, float]] = field(default_factory=dict)
    seen: dict[frozenset[str], Choice] = field(default_factory=dict)
    wide: bool = False
    quick: bool = False

    @property
    def clear(self) -> float:
        """The gain from which on what gains much less is not followed."""
        return np.inf if self.wide else CLEAR

    def tried_in_vain(self, key: Key, choice: Choice) -> bool:
        """Whether the terms and forms of `key` were tried in vain in place of such a choice.

        A choice that has moved since by less than CAUGHT_UP of what they were behind is such a one.
        """
        score, behind = self.vain.get(key, (np.inf, 0.0))
        return abs(score - choice.score) < max(SAME, CAUGHT_UP * behind)

    def weighed(self, fit: Fit, place: Place, iterations: int = 4) -> Choice:
        """A fit under the noise that suits its own residual, refitted there, and its score.

        Begun from the noise given and, where that wanders, also from noise that does not: else a
        walk takes over what a drift should explain.
        """
        choice = self._weighed_from(fit, place, iterations)
        if wanders(choice.place):
            settled, still = self.stilled(fit, choice.place, iterations)
            other = self._weighed_from(settled, still, iterations)
            choice = min(choice, other, key=lambda c: c.score)
        known = self.seen.setdefault(frozenset(choice.fit.names), choice)
        self.seen[frozenset(choice.fit.names)] = min(known, choice, key=lambda c: c.score)
        return choice

    def whitened(self, choice: Choice) -> Choice:
        """The choice, or what becomes of it from noise without memory, if better.

        Noise that is correlated takes over what slow errors of sizes and moments leave, and its
        terms, fitted beside it, leave them there.
        """
        if choice.place[0] == WHITE or len(self.family.shapes) == 1 or not choice.fit.pieces:
            return choice
        other = self.weighed(*self.stilled(choice.fit, (WHITE, 0, 0), 4))
        return min(choice, other, key=lambda c: c.score)

    def stilled(self, fit: Fit, place: Place, iterations: int) -> tuple[Fit, Place]:
        """The fit under noise of the shape of a place that neither jitters nor walks."""
        still = (place[0], 0, 0)
        residual = np.where(fit.ground.used, fit.ground.problem.measured - fit.predicted, 0.0)
        noise = self.family.noise_at(still, self.family.weigh(still, residual)[1])
        ground = fit.ground.with_noise(noise)
        return improve(calibrated(ground, fit.pieces, fit.trace), iterations), still

    def hoped(self, fit: Fit, place: Place) -> float:
        """About the score that a fit will have, before it has its own noise."""
        return min(self.scored(fit, p) for p in {place, (place[0], 0, 0)})

    def may_beat(self, choice: Choice, fit: Fit) -> bool:
        """Whether a fit, once it has its own noise, may be better than a choice."""
        return choice.score - self.hoped(fit, choice.place) > -FAINT

    def better(self, choice: Choice, fit: Fit) -> Choice:
        """The choice, or what a fit comes to with its own noise, if that is better."""
        if not self.may_beat(choice, fit):
            return choice
        return min(choice, self.weighed(fit, choice.place), key=lambda c: c.score)

    def scored(self, fit: Fit, place: Place) -> float:
        """The score of a fit's residual under the noise of a place."""
        ground = fit.ground
        residual = np.where(ground.used, ground.problem.measured - fit.predicted, 0.0)
        own = fit.cost - 2.0 * ground.log_scale - float(fit.innovations @ fit.innovations)
        return self.family.weigh(place, residual)[0] + own + complexity(fit)

    def _weighed_from(self, fit: Fit, place: Place, iterations: int) -> Choice:
        residual = fit.ground.problem.measured - fit.predicted
        noise, place = self.family.pick(residual, place)
        ground = fit.ground.with_noise(noise)
        fit = improve(calibrated(ground, fit.pieces, fit.trace), iterations)
        hidden = VOID if self.hides_drift(fit, place) else 0.0
        return Choice(fit, place, self.scored(fit, place) + hidden)

    def hides_drift(self, fit: Fit, place: Place) -> bool:
        """Whether noise that walks takes what the catalogue calls a drift.

        A zero that wanders by more than the noise is one, by much more where repeats say what noise
        is.
        """
        if place[2] == 0 or fit.slow:
            return False
        most = FAR_WALK if self.family.prior.repeats > 0 else NEAR_WALK
        residual = (fit.ground.problem.measured - fit.predicted)[fit.ground.used]
        return bool(np.var(residual) > most * fit.ground.noise.deviation**2)


def among(search: Search, problem: Problem, terms: tuple[Term, ...]) -> Search:
    """The search among other terms."""
    return replace(search, terms=terms, effects=effects_of(problem, terms), vain={})


def names(choice: Choice) -> frozenset[str]:
    """The names of its terms."""
    return frozenset(choice.fit.names)


def piled(choice: Choice) -> bool:
    """Whether a choice has as many names as a search takes: it may mop up what other names tell."""
    return len(names(choice)) >= MOST_TERMS


def by_names(choices: list[Choice]) -> list[Choice]:
    """The best choice of each set of names, in their order."""
    found: dict[frozenset[str], Choice] = {}
    for choice in sorted(choices, key=lambda c: c.score):
        found.setdefault(names(choice), choice)
    return list(found.values())


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


def best_of_each(choices: Sequence[Choice]) -> list[Choice]:
    """The best choice of each set of terms and forms, the best first."""
    best: dict[Key, Choice] = {}
    for choice in sorted(choices, key=lambda c: c.score):
        best.setdefault(choice.fit.key, choice)
    return list(best.values())


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
        groups = by_term(screen(start, search.effects, own, quick=search.quick))
        groups = leading(groups, branches, lambda few: (few[0].term.name, few[0].term.kin))
        for few in hopeful(groups, 0.0 if unknown else TERM_COST, search.clear):
            trial = improve(started(start, few), 3, start)
            if trial.cost > start.cost - TERM_COST:
                trial = improve(trial, 6)
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


def worthwhile(
    search: Search, parent: Choice, trials: Sequence[Fit], slow: Sequence[Fit], most: int
) -> list[Fit]:
    """The best few trials, and the best of each slow name, that may still become the best.

    So may a wave beside the other courses of a drift, which come near it sooner.

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
    own: dict[tuple[str, bool], Fit] = {}
    for trial in sorted(slow, key=hope, reverse=True):
        last = trial.pieces[-1].term
        own.setdefault((last.name, last.form == "wave"), trial)
    best: dict[Key, Fit] = {}
    for trial in sorted((*few, *own.values()), key=hope, reverse=True):
        best.setdefault(trial.key, trial)
    most_hoped = max(hopes.values(), default=0.0)
    return [t for t in best.values() if most_hoped < search.clear or hope(t) > BEHIND * most_hoped]


def leading(items: Sequence[T], most: int, idea: Callable[[T], Hashable]) -> list[T]:
    """The first items up to `most` different ideas, and all that are the same idea as one."""
    ideas = set(list(dict.fromkeys(idea(item) for item in items))[:most])
    return [item for item in items if idea(item) in ideas]


def wanders(place: Place) -> bool:
    """Whether a noise jitters or walks, and so may take over what a slow term should explain."""
    return place[1] > 0 or place[2] > 0


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
    """Whether two terms can't stand beside each other."""
    if term.group:
        return term.group == other.group
    return (term.name, term.side) == (other.name, other.side)


def grown(search: Search, choice: Choice, but: Container[str] = ()) -> Choice:
    """The choice with each term in the richer form that its score prefers, if any.

    but: names whose forms stay. A form that fits no better can't be worth its parameters. What is
    scanned for is looked for beside the form as it was: another one may have taken a part of it.
    """
    problem = choice.fit.ground.problem
    for i, piece in enumerate(choice.fit.pieces):
        begun = choice.fit
        for term in () if piece.term.name in but else richer(piece.term):
            key = choice.fit.key - {(piece.term.name, piece.term.form)} | {(term.name, term.form)}
            if search.tried_in_vain(key, choice):
                continue
            if not term.excited(problem.motion, problem.around):
                continue
            fit = reformed(begun if term.scanned else choice.fit, i, term)
            trial, behind = choice, max(complexity(fit) - complexity(choice.fit), 0.0)
            if fit.cost < choice.fit.cost:
                trial = search.weighed(fit, choice.place)
                behind = trial.score - choice.score
            if trial.score < choice.score:
                choice = trial
            else:
                search.vain[key] = choice.score, behind
    return choice


def simpler(search: Search, choice: Choice) -> Choice:
    """The choice with each term in a plainer form that its score prefers, if any.

    A form grown beside fewer terms may hold what another one explains by now.
    """
    for i, piece in enumerate(choice.fit.pieces):
        for term in plainer(search.terms, piece.term):
            key = choice.fit.key - {(piece.term.name, piece.term.form)} | {(term.name, term.form)}
            if search.tried_in_vain(key, choice):
                continue
            trial = search.weighed(reformed(choice.fit, i, term), choice.place)
            if trial.score < choice.score:
                return simpler(search, trial)
            search.vain[key] = choice.score, trial.score - choice.score
    return choice


def plainer(terms: Sequence[Term], term: Term) -> list[Term]:
    """Forms of the same name, among some terms and what they grow to, that a term grew from."""
    known = with_richer(t for t in terms if t.name == term.name)
    return [t for t in known if any(r.form == term.form for r in richer(t) if r.name == t.name)]

"""The choices of a search, each weighed under the noise that suits it."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from pipeline.discrepancy.fitting.charge import VOID, complexity
from pipeline.discrepancy.fitting.effects import Effects, effects_of
from pipeline.discrepancy.fitting.fit import ITERATIONS, Fit, calibrated, evaluate, improve
from pipeline.discrepancy.noise.family import WHITE, NoiseFamily, Place
from pipeline.discrepancy.problem.problem import Problem
from pipeline.discrepancy.search.elsewhere import Key
from pipeline.physics.term import Term

MOST_TERMS = 4
LEAST_GAIN = 6.0
TIE, RIVAL_GAP = 9.0, 14.0
SAME, CAUGHT_UP = 1.0, 0.3
CLEAR, FAINT = 60.0, 15.0
NEAR_WALK, FAR_WALK = 2.0, 25.0


@dataclass(frozen=True)
class Choice:
    """A fit with its own noise and its score: -2 log evidence (BIC) with a charge for each term."""

    fit: Fit
    place: Place
    score: float

    def but_for(self, name: str) -> "Choice":
        """The same without the pieces of a name, the rest refitted; its score is as it was."""
        fit = improve(evaluate(self.fit.ground, self.fit.but_for(name)))
        return replace(self, fit=fit)


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

    def best_begun(self, key: Key, choice: Choice, begun: Sequence[Fit]) -> Choice:
        """The choice, or what the most promising of some fits comes to, if that is better.

        Else the terms and forms of `key` were tried in vain.
        """
        promising = min(begun, key=lambda f: f.cost + complexity(f))
        found = self.better(choice, improve(promising, 2 * ITERATIONS))
        if found is choice:
            self.vain[key] = choice.score, 0.0
        return found

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


def best_of_each(choices: Sequence[Choice]) -> list[Choice]:
    """The best choice of each set of terms and forms, the best first."""
    best: dict[Key, Choice] = {}
    for choice in sorted(choices, key=lambda c: c.score):
        best.setdefault(choice.fit.key, choice)
    return list(best.values())


def wanders(place: Place) -> bool:
    """Whether a noise jitters or walks, and so may take over what a slow term should explain."""
    return place[1] > 0 or place[2] > 0

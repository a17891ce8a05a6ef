"""Ties: explanations that these data can't tell from the best one."""

from dataclasses import dataclass

import numpy as np

from pipeline.discrepancy.fitting.charge import complexity
from pipeline.discrepancy.problem.problem import Problem
from pipeline.discrepancy.search.disguise import as_itself, limits, may_stand_for, plain, plainly
from pipeline.discrepancy.search.equivalents import equivalents
from pipeline.discrepancy.search.weighing import RIVAL_GAP, TIE, Choice, by_names, names
from pipeline.physics.backlash import Backlash
from pipeline.physics.catalogue import BENDS
from pipeline.physics.friction import Friction

NEGLIGIBLE = 1e-4
TEMPERATURE = 2.0


@dataclass(frozen=True)
class Standing:
    """How sure a name is: its probability, and the names that could stand in its place.

    Last come other names of the same thing (`Term.other_names`), or of play in its place. tied:
    whether one of the others fits as well in these data, or would in any (what bends one curve).
    """

    probability: float
    alternatives: tuple[str, ...]
    tied: bool


def weights_of(choices: list[Choice]) -> np.ndarray:
    """Probability of each choice among those found, (k,), tempered."""
    scores = np.array([c.score for c in choices])
    weights = np.exp(-0.5 * (scores - scores.min()) / TEMPERATURE)
    return weights / weights.sum()


def standing(name: str, best: Choice, choices: list[Choice], problem: Problem) -> Standing:
    """What the other choices say of a name of the best one; one in disguise may be that other.

    Those that are the best one in disguise say nothing, but for slack that may be what bends, and
    for what may be mistaken for this name (`Term.mistaken_for`): it is charged for parameters that
    tell nothing there, and ties if it fits better, unless it comes to this name there. Nor need
    such a name be in disguise to be listed, where all that it is behind is its charge for more
    parameters. One that is this name in disguise, but may be itself for all that the data show
    (`Term.may_be_itself`), ties by its score. Where one bend of a static curve could stand in its
    place, each could; not in that of one that another axis turns. Nor is what becomes another with
    time the same as what doesn't.
    """
    distinct = by_names(choices)
    weights = weights_of(distinct)
    likely = [(w, c) for w, c in zip(weights, distinct, strict=True) if w > NEGLIGIBLE]
    shown = plain if name in plain(best) else names
    probability = float(sum(w for w, c in likely if name in shown(c)))
    hidden = dict(zip(best.fit.names, plainly(best.fit), strict=True))[name]
    gaps = {} if hidden in names(best) else {hidden: 0.0}
    looks_so: list[str] = []
    for choice in distinct:
        other = names(choice) - names(best)
        swapped = name not in names(choice) and len(names(choice)) == len(names(best))
        gap = choice.score - best.score
        if swapped and (name in BENDS or as_itself(choice, best) or may_stand_for(choice, best)):
            for one in other:
                gaps.setdefault(one, gap)
            if mistaken_for(other, choice) == {name} and gap < TIE + spare(choice, best):
                looks_so = sorted({*looks_so, *other})
        elif swapped and gap < RIVAL_GAP and mistaken_for(other, choice) == {name}:
            looks_so = sorted(other)
            gaps |= dict.fromkeys(other, gap) if gap < 0.0 and name not in limits(choice) else {}
    tied = [n for n, gap in gaps.items() if gap < TIE]
    own = [p for p in best.fit.pieces if p.term.name == name]
    steady = not any(p.term.goes_by or p.term.evolves for p in own)
    every = (*([name] if steady else []), *(BENDS & set(tied)))
    alike = [n for one in every for n in equivalents(one, problem)]
    like = dict.fromkeys([*looks_so, *sorted(alike)])
    both = len({p.term.side for p in own}) > 1
    also = [n for p in own for n in p.term.also_at(p.values, problem.around)]
    also = list(dict.fromkeys([*also, *(n for p in own if both for n in p.term.also_on_both)]))
    tied += [n for n in also if n not in names(best) | set(tied)]
    known = [n for n in like if n not in names(best) | set(tied)]
    unsettled = bool(tied) or bool(name in BENDS and known)
    same = {n for p in own for n in p.term.other_names(p.values, problem.around)}
    same |= {Friction.name} if Backlash.name in {*tied, *known} else set()
    called = sorted(same - names(best) - {*tied, *known})
    return Standing(probability, (*sorted(tied), *known, *called), unsettled)


def spare(choice: Choice, best: Choice) -> float:
    """How much more a choice is charged than the best one for its terms; at most RIVAL_GAP."""
    return min(max(complexity(choice.fit) - complexity(best.fit), 0.0), RIVAL_GAP)


def mistaken_for(told: frozenset[str], choice: Choice) -> set[str]:
    """What some of a choice's names may be mistaken for."""
    return {p.term.mistaken_for for p in choice.fit.pieces if p.term.name in told}

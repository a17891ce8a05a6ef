"""Contested names: what comes near the best explanation gets a search of its own."""

from collections.abc import Sequence, Set
from dataclasses import replace

from pipeline.discrepancy.fitting.fit import evaluate, improve
from pipeline.discrepancy.search.choose import choose
from pipeline.discrepancy.search.disguise import plain
from pipeline.discrepancy.search.growth import grown, simpler
from pipeline.discrepancy.search.moves import recurved
from pipeline.discrepancy.search.polish import polished
from pipeline.discrepancy.search.weighing import (
    LEAST_GAIN,
    RIVAL_GAP,
    Choice,
    Search,
    best_of_each,
    by_names,
    names,
)
from pipeline.physics.catalogue import BENDS

MOST, LEVELLED = 2, 4
FAR, WORTH = 3.0 * RIVAL_GAP, 100.0


def contested(search: Search, choices: Sequence[Choice]) -> list[Choice]:
    """The choices (best first), with those of searches confined to the names of near rivals.

    Terms that a search added on its way lead the others to sizes from which no small step leads
    back. So before a name of several is believed, the best few sets without it are looked for from
    the beginning, among their own names only, until one wins clearly. What bends one static curve
    is one name here: where such a set wins, others that draw its curve are tried in it.
    """
    best, found = choices[0], list(choices)
    ground = next(c for c in choices if not c.fit.pieces).fit.ground
    for wanted in rival_names(choices)[:MOST]:
        own = tuple(t for t in search.terms if t.name in wanted)
        confined = replace(search, terms=own, wide=False)
        own_choices = choose(confined, ground)
        if own_choices[0].score < best.score + RIVAL_GAP:
            own_choices = polished(confined, own_choices)
        found += own_choices
        if own_choices[0].score < best.score - LEAST_GAIN:
            break
    won = min(found, key=lambda c: c.score)
    return best_of_each([*found, recurved(search, won)] if won is not best else found)


def levelled(search: Search, choices: Sequence[Choice]) -> list[Choice]:
    """The choices (best first), with near rivals of other names in forms as rich as suit them.

    They have one other name, or two in place of one. A search grows the forms of what is best on
    its way: a rival that was left with plainer ones looks worse than its name is, and so does one
    grown beside fewer. It takes over the forms of the names that both have, or the other bend of a
    static curve; its own names are made plain, or grown. What is slow is left as it is: enough
    slips follow any drift. Sets of one name fewer are made plain and grown as a whole: their forms
    grew beside the name that is gone.
    """
    best, found = choices[0], list(choices)
    near = [c for c in by_names(list(choices)) if c.score < best.score + FAR]
    near = [c for c in near if c.fit.slow <= names(best)]
    mine = bent(names(best))
    others = [c for c in near if len(bent(names(c)) - mine) == len(mine - bent(names(c))) == 1]
    pairs = [c for c in near if len(bent(names(c)) - mine) == 2 * len(mine - bent(names(c))) == 2]
    for rival in (*others[:LEVELLED], *pairs[:1]):
        shared = [p for p in best.fit.pieces if bent({p.term.name}) <= bent(names(rival))]
        own = [p for p in rival.fit.pieces if not bent({p.term.name}) <= bent(names(best))]
        taken = evaluate(best.fit.ground, (*shared, *own))
        if taken.key != rival.fit.key:
            taken_over = search.weighed(improve(taken), best.place)
            rival = min(rival, taken_over, key=lambda c: c.score)
        if not names(rival) & BENDS <= names(best):
            rival = recurved(search, rival)
        found.append(grown(search, simpler(search, rival), but=names(best)))
    found += [grown(search, simpler(search, fewer)) for fewer in one_name_fewer(choices)]
    return best_of_each(found)


def one_name_fewer(choices: Sequence[Choice]) -> list[Choice]:
    """The best of each set of all names of the best choice but one, if it is not far behind."""
    all_names = names(choices[0])
    near = [c for c in by_names(list(choices)) if c.score < choices[0].score + WORTH]
    sets = [c for c in near if c.fit.pieces and names(c) < all_names]
    return [c for c in sets if len(names(c)) + 1 == len(all_names)]


def rival_names(choices: Sequence[Choice]) -> list[frozenset[str]]:
    """Sets of names near the best one that lack one of its names, the best first; none for one.

    Not those that have it in disguise.
    """
    best = choices[0]
    if len(names(best)) < 2:
        return []
    out: dict[Set[str], frozenset[str]] = {}
    for choice in choices:
        near = choice.fit.pieces and choice.score < best.score + RIVAL_GAP
        if near and not bent(names(best)) <= bent(names(choice)) | plain(choice):
            out.setdefault(bent(names(choice)), names(choice))
    return list(out.values())


def bent(found: Set[str]) -> Set[str]:
    """Names, those of what bends one static curve under one."""
    return found if BENDS.isdisjoint(found) else (found - BENDS) | {"bend"}

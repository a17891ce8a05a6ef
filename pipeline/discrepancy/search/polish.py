"""Polish: deletions, swaps, richer forms and moves of the best choice while it gets better."""

import numpy as np

from pipeline.discrepancy.fitting.fit import evaluate, improve
from pipeline.discrepancy.search.choose import extended
from pipeline.discrepancy.search.coasted import coasted
from pipeline.discrepancy.search.crept import crept
from pipeline.discrepancy.search.elsewhere import Key, freed
from pipeline.discrepancy.search.exchange import exchanged
from pipeline.discrepancy.search.flanked import flanked
from pipeline.discrepancy.search.growth import grown
from pipeline.discrepancy.search.lined import lined
from pipeline.discrepancy.search.moves import (
    merged,
    parted,
    recurved,
    sheathed,
    unpromised,
    unshifted,
)
from pipeline.discrepancy.search.one_damper import one_damper
from pipeline.discrepancy.search.one_late import one_late
from pipeline.discrepancy.search.played import played
from pipeline.discrepancy.search.queued import queued
from pipeline.discrepancy.search.redrawn import redrawn
from pipeline.discrepancy.search.refuted import mops_up
from pipeline.discrepancy.search.rubbed import rubbed
from pipeline.discrepancy.search.stepped import stepped
from pipeline.discrepancy.search.stopping import stopping
from pipeline.discrepancy.search.twofold import twofold
from pipeline.discrepancy.search.weighing import MOST_TERMS, SAME, Choice, Search, best_of_each
from pipeline.physics.backlash import Backlash
from pipeline.physics.friction import Friction

WORTH, ROUNDS = 150.0, 6
MOVES = (
    unpromised, unshifted, stepped, recurved, played, coasted, stopping, rubbed, twofold, lined,
    parted, crept, queued, one_damper, one_late, flanked, redrawn,
)  # fmt: skip
Tried = dict[Key, tuple[float, float]]


def polished(search: Search, choices: list[Choice]) -> list[Choice]:
    """Richer forms, deletions and swaps of the best as long as it gets better.

    Where friction that is a share of the pull suits the best better than friction of one width, or
    than play in its place, it is polished so as well: what mends the one form's error would hide
    the other.
    """
    best = min(choices, key=lambda c: c.score)
    alone = next((c for c in choices if c.fit.names == ("friction",)), best)
    found = _polished(search, best_of_each([*choices, exchanged(search, alone)]))
    plain = min(
        (c for c in found if set(c.fit.names) == set(best.fit.names)), key=lambda c: c.score
    )
    rubbing = frozenset(Friction.name if n == Backlash.name else n for n in found[0].fit.names)
    for start in {id(c): c for c in (plain, alone, search.seen.get(rubbing, plain))}.values():
        sheath = sheathed(search, start)
        if sheath is not start and sheath.score < min(found[0].score, start.score):
            found = best_of_each([*found, *_polished(search, [*choices, sheath])])
    return found


def _polished(search: Search, choices: list[Choice]) -> list[Choice]:
    found = {c.fit.key: c for c in choices}
    tried: Tried = {}
    for _ in range(ROUNDS):
        best = min(found.values(), key=lambda c: c.score)
        begun = best.score
        richest = search.whitened(exchanged(search, merged(search, grown(search, best))))
        if richest is not best:
            found[richest.fit.key] = best = richest
        swap(search, best, found, tried)
        before, best = best, min(found.values(), key=lambda c: c.score)
        if before.score - best.score < SAME:
            further = [*(move(search, best) for move in MOVES), *furthered(search, best)]
            more = min(further, key=lambda c: c.score)
            if more.score < best.score:
                found[more.fit.key] = more
            if more.score > best.score - SAME:
                break
        now = min(found.values(), key=lambda c: c.score)
        if mops_up(search, now, begun - now.score):
            break
    else:
        fewest = thinned(search, min(found.values(), key=lambda c: c.score))
        found[fewest.fit.key] = fewest
    return sorted(found.values(), key=lambda c: c.score)


def swap(search: Search, best: Choice, found: dict[Key, Choice], tried: Tried) -> None:
    """Find the best without each of its terms, and with each of the promising others instead.

    A swap begins from the rest refitted, and from the rest as it stood beside the old term. Where
    the rest was tried before, others are looked for beside it only if it does better now: the best
    has moved since, and what it holds with it. tried: scores of the best and of the rest then.
    """
    for piece in best.fit.pieces:
        rest = best.fit.without(piece)
        key = frozenset((p.term.name, p.term.form) for p in rest)
        then, least = tried.get(key, (np.inf, np.inf))
        if best.score > then - SAME:
            continue
        fit = freed(improve(evaluate(best.fit.ground, rest)))
        without = search.weighed(fit, best.place)
        tried[key] = best.score, min(without.score, least)
        if without.score > least - SAME:
            continue
        if without.score < best.score + WORTH:
            without = grown(search, without)
        found[without.fit.key] = without
        if without.fit.key != key:
            found.setdefault(key, without)
        unmoved = evaluate(without.fit.ground, rest)
        for child in extended(search, without, 5, begun=[unmoved]):
            if child.fit.key not in found or child.score < found[child.fit.key].score:
                found[child.fit.key] = child


def furthered(search: Search, choice: Choice) -> list[Choice]:
    """The choice with each of the most promising further terms: the beam took it another way.

    Only where cycles repeat: elsewhere nothing but the terms themselves says what is noise, and
    a further one fits some of it.
    """
    if search.family.prior.repeats == 0 or len(choice.fit.pieces) >= MOST_TERMS:
        return []
    return extended(search, choice)


def thinned(search: Search, choice: Choice) -> Choice:
    """The choice without the terms that earn nothing any more beside the others."""
    for piece in choice.fit.pieces:
        rest = choice.fit.without(piece)
        fewer = search.weighed(improve(evaluate(choice.fit.ground, rest)), choice.place)
        if fewer.score < choice.score:
            return thinned(search, fewer)
    return choice

"""A static curve drawn anew."""

from collections.abc import Sequence
from dataclasses import replace

from pipeline.discrepancy.fitting.fit import ITERATIONS, Fit, evaluate, improve
from pipeline.discrepancy.noise.family import Place
from pipeline.discrepancy.search.choose import extended
from pipeline.discrepancy.search.growth import grown
from pipeline.discrepancy.search.moves import curves, trials_with
from pipeline.discrepancy.search.refuted import refuted
from pipeline.discrepancy.search.weighing import Choice, Search
from pipeline.physics.term import Term

FOLLOWED, FURTHER = 5, 2
HOPED, FAR = 100.0, 300.0
DRAWN = ("drawn", "anew")


def redrawn(search: Search, choice: Choice) -> Choice:
    """The choice with all that draws its static curve taken out and looked for anew, if better.

    Two terms that draw a curve together come near what others draw: each has taken a part of the
    other's place, and from there no swap of one leads to them. Nor is what gains most alone one of
    them: so each pair of names is tried, and the best of them with a third. Where repeats say that
    more is left than noise, another shape of the curve is not what is missing.
    """
    fit = choice.fit
    curved = [p for p in fit.pieces if curves(p.term)]
    key = fit.key | {DRAWN}
    if len(curved) < 2 or search.tried_in_vain(key, choice) or refuted(search, choice):
        return choice
    terms = tuple(t for t in search.terms if curves(t))
    rest = improve(evaluate(fit.ground, fit.without(*curved)))
    pairs = pairs_with(search, rest, terms, choice.place)
    best: dict[frozenset[tuple[str, float]], Fit] = {}
    for pair in sorted(pairs, key=lambda t: search.hoped(t, choice.place)):
        best.setdefault(frozenset((p.term.name, p.term.side) for p in pair.pieces), pair)
    begun = [
        search.weighed(improve(pair, 2 * ITERATIONS), choice.place)
        for pair in list(best.values())[:FOLLOWED]
    ]
    own = replace(search, terms=terms, wide=True, vain={})
    near = [c for c in sorted(begun, key=lambda c: c.score) if c.score < choice.score + FAR]
    more = [third for pair in near[:FURTHER] for third in extended(own, pair, 3)]
    other = [c for c in (*begun, *more) if c.fit.key != fit.key and c.score < choice.score + HOPED]
    drawn = [grown(search, c) for c in sorted(other, key=lambda c: c.score)[:FURTHER]]
    found = min([choice, *drawn], key=lambda c: c.score)
    search.vain[key] = choice.score, 0.0
    return found


def pairs_with(search: Search, fit: Fit, terms: Sequence[Term], place: Place) -> list[Fit]:
    """The fit with each pair of some terms, begun from the one of them that is better alone."""
    ones = sorted(each_with(search, fit, terms), key=lambda t: search.hoped(t, place))
    left, pairs = list(terms), []
    for one in ones:
        pairs += each_with(search, one, left)
        begun = one.pieces[-1].term
        left = [t for t in left if (t.name, t.side) != (begun.name, begun.side)]
    return pairs


def each_with(search: Search, fit: Fit, terms: Sequence[Term]) -> list[Fit]:
    """The fit with one more of some terms, the best start of each name and side."""
    best: dict[tuple[str, float], Fit] = {}
    for trial in trials_with(search, fit, terms):
        key = trial.pieces[-1].term.name, trial.pieces[-1].term.side
        if key not in best or trial.cost < best[key].cost:
            best[key] = trial
    return list(best.values())

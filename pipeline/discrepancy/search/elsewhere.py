"""What may act at one place of the chain or at another.

A creep acts in the balance at the joint, or after it, where what holds the joint answers to it no
more; play turns before the shaft's ripple or behind it. Such physics has a form for each place
(`Term.elsewhere`). They differ only beside some terms (`Term.only_beside`); elsewhere they are one
idea, share one place in a search, and only the usual form is offered.
"""

from collections.abc import Iterable, Mapping
from dataclasses import replace

from pipeline.discrepancy.fitting.fit import TOLERANCE, Fit, evaluate, improve
from pipeline.physics.piece import Piece
from pipeline.physics.term import Term

Key = frozenset[tuple[str, str]]


def there(fit: Fit) -> frozenset[str]:
    """What terms that differ only beside something find in a fit."""
    return frozenset().union(*(p.term.matters_to for p in fit.pieces))


def differing(terms: Iterable[Term], fit: Fit) -> list[Term]:
    """Those of some terms that beside a fit's are not the same as their usual form."""
    found = there(fit)
    return [t for t in terms if not t.only_beside or t.only_beside in found]


def pieces_elsewhere(fit: Fit) -> dict[str, list[Piece]]:
    """A fit's pieces with terms at their other place, by what that makes a difference beside."""
    places = [{t.only_beside: t for t in p.term.elsewhere()} for p in fit.pieces]
    return {
        beside: [
            replace(p, term=own[beside]) if beside in own else p
            for p, own in zip(fit.pieces, places, strict=True)
        ]
        for beside in dict.fromkeys(beside for own in places for beside in own)
    }


def with_others_elsewhere(fit: Fit) -> dict[str, Fit]:
    """The fit with terms at their other place, by what that makes a difference beside."""
    found = {k: evaluate(fit.ground, pieces) for k, pieces in pieces_elsewhere(fit).items()}
    return {
        beside: moved if abs(moved.cost - fit.cost) < TOLERANCE else improve(moved, 3)
        for beside, moved in found.items()
    }


def in_better_order(trials: Mapping[Key, Fit]) -> list[Fit]:
    """Trials of one parent, of those that differ in the order on the shaft alone the best one.

    That shows at once; what a joint does that is held, only when what holds it has been fitted.
    """
    best: dict[Key, Fit] = {}
    for trial in sorted(trials.values(), key=lambda t: t.cost):
        best.setdefault(
            frozenset((p.term.name, p.term.in_usual_order) for p in trial.pieces), trial
        )
    kept = {id(trial) for trial in best.values()}
    return [trial for trial in trials.values() if id(trial) in kept]


def freed(fit: Fit) -> Fit:
    """The fit, with terms at their other place where that makes a difference, if better."""
    found, others = there(fit), pieces_elsewhere(fit)
    moved = [improve(evaluate(fit.ground, others[k])) for k in others if k in found]
    return min([fit, *moved], key=lambda f: f.cost)


def kin_of(fit: Fit) -> Key:
    """The names of a fit's terms, forms that differ only beside others as one."""
    return frozenset((p.term.name, p.term.kin) for p in fit.pieces)
